# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Covariances that are wrong by a known factor are found out, and the tail of the errors with them."""

from pathlib import Path

import numpy as np
import pytest
from scipy.stats import multivariate_t

from fairlead.io.errors import InputError
from fairlead.io.network_card import Calibration
from fairlead.train.accuracy import draw_reliability, lines, markdown
from fairlead.train.calibrate import read_calibration, write_calibration
from fairlead.train.calibration import declared, fit, nees, squared, visible_threshold
from fairlead.train.findings import Findings

FACTORS = np.array([0.5, 1.0, 3.0])
"""Variance of each landmark in units of what the network says."""


def findings(dof: float, count: int = 6000, seed: int = 0) -> Findings:
    """Errors of a Student t whose covariance is FACTORS times the stated one; the last tenth is hidden, badly found."""
    rng = np.random.default_rng(seed)
    landmark = np.arange(count) % 3
    cholesky = np.column_stack([rng.normal(0.3, 0.5, (count, 2)), rng.normal(0.0, 0.5, count)])
    L = np.zeros((count, 2, 2))
    L[:, 0, 0], L[:, 1, 1], L[:, 1, 0] = np.exp(cholesky[:, 0]), np.exp(cholesky[:, 1]), cholesky[:, 2]
    shape = np.eye(2) * (dof - 2.0) / dof
    white = multivariate_t(np.zeros(2), shape, df=dof, seed=rng).rvs(count)
    error = np.sqrt(FACTORS[landmark])[:, None] * np.einsum("mij,mj->mi", L, white)
    visible = np.full(count, 4.0) + 0.5 * rng.standard_normal(count)
    visible[-count // 10 :] -= 8.0
    return Findings(
        condition=np.zeros(count, int), picture=np.arange(count) // 3, landmark=landmark,
        visibility=np.where(visible > 0.0, 2, 1), error=error, cholesky=cholesky, visible=visible,
        unit=np.full(count, 0.5), range_m=np.full(count, 1000.0), azimuth_deg=np.full(count, 170.0),
        jacobian=np.zeros((count, 2, 6)),
    )  # fmt: skip


@pytest.mark.parametrize("dof", [5.0, 30.0])
def test_factor_and_tail_are_found(dof: float) -> None:
    """1800 errors a landmark: the variance of a variance is (kurtosis - 1) / n, 5 % where there are four moments."""
    calibration = fit(findings(dof), 3)
    assert np.allclose(np.array(calibration.scale) / FACTORS, 1.0, atol=0.25 if dof < 6.0 else 0.12)
    assert calibration.floor_px == pytest.approx(0.0, abs=0.21)
    assert calibration.tail_dof is not None
    assert 0.6 * dof <= calibration.tail_dof <= 2.0 * dof
    fresh = findings(dof, seed=1)
    told = declared(fresh, calibration.visible_threshold)
    assert 0.5 * np.mean(squared(fresh.where(told), calibration, 3)) == pytest.approx(1.0, abs=0.1)


def test_a_few_gross_errors_do_not_decide() -> None:
    """One error in two hundred is a hundred times as long: counted in full it would widen everything fifty times."""
    clean, spoilt = findings(30.0), findings(30.0)
    spoilt.error[::200] *= 100.0
    calibration = fit(spoilt, 3)
    assert (np.array(calibration.scale) / np.array(fit(clean, 3).scale) < 1.15).all()
    s = squared(spoilt.where(declared(spoilt, calibration.visible_threshold)), calibration, 3)
    assert nees(s).mean() == pytest.approx(1.0, abs=0.02)
    assert 0.5 * s.mean() > 20.0


def test_the_threshold_parts_what_is_seen_from_what_is_not() -> None:
    assert -2.5 < visible_threshold(findings(5.0)) < 4.0
    assert declared(findings(5.0), visible_threshold(findings(5.0))).mean() == pytest.approx(0.9, abs=0.01)


def test_the_squared_error_is_that_of_the_covariance() -> None:
    few = findings(5.0, count=30)
    calibration = Calibration(scale=(2.0, 3.0, 4.0), floor_px=0.7)
    found = squared(few, calibration, 3)
    for k in (0, 4, 29):
        a, b, c = few.cholesky[k]
        L = np.array([[np.exp(a), 0.0], [c, np.exp(b)]])
        S = calibration.scale[k % 3] * L @ L.T + 0.49 * np.eye(2)
        assert found[k] == pytest.approx(few.error[k] @ np.linalg.solve(S, few.error[k]))


def test_tables_leave_no_visible_landmark_out(tmp_path: Path) -> None:
    """Also those that the network calls hidden count, and in the flight's pixels."""
    rows = findings(5.0)
    rows.visible[rows.landmark == 1] = -9.0  # called hidden
    calibration = Calibration(visible_threshold=0.0, tail_dof=5.0)
    table = lines(rows, calibration, ("a", "b", "c"), ("clear",))
    seen = rows.visibility == 2
    assert table[0].mean_px == pytest.approx(0.5 * np.linalg.norm(rows.error[seen], axis=1).mean())
    assert table[0].visible == seen.sum()
    by_name = {(line.group, line.name): line for line in table}
    assert by_name["landmark", "b"].told == 0.0
    assert by_name["aspect", "astern"].visible == by_name["range", "700 to 1400 m"].visible == seen.sum()
    assert "| clear | " in markdown(table)
    draw_reliability(tmp_path / "reliability.png", rows, calibration, ("a", "b", "c"))
    assert (tmp_path / "reliability.png").stat().st_size > 10_000


def test_a_calibration_is_read_back(tmp_path: Path) -> None:
    calibration = Calibration(visible_threshold=-0.25, floor_px=0.4, scale=(1.5, 2.0, 0.25), tail_dof=4.0)
    write_calibration(tmp_path / "c.toml", calibration)
    assert read_calibration(tmp_path / "c.toml", 3) == calibration
    with pytest.raises(InputError, match="scale"):
        read_calibration(tmp_path / "c.toml", 4)
