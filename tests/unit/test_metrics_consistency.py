# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""docs/metrics.md eq. (18)-(20), computed by hand."""

import math

import numpy as np
import pytest

from fairlead import geometry
from fairlead.evaluate.consistency import (
    NormalisedSquare,
    chi_square_band,
    model_normalised_square,
    nees,
    normalised_square,
    pose_normalised_square,
)
from fairlead.types import Target


def test_normalised_square_eq_18() -> None:
    found = normalised_square(np.array([2.0, 1.0, 0.0]), np.diag([4.0, 1.0, 9.0]))
    assert (found.value, found.dof, found.outside) == (pytest.approx(2.0), 3, False)


def test_units_do_not_matter() -> None:
    P = np.array([[4.0, 1.9], [1.9, 1.0]])
    e = np.array([1.0, 0.3])
    scale = np.diag([1e-6, 1e6])
    assert normalised_square(scale @ e, scale @ P @ scale).value == pytest.approx(normalised_square(e, P).value)
    assert normalised_square(e, P).value == pytest.approx(float(e @ np.linalg.solve(P, e)))


def test_rank_deficient_covariance_counts_its_rank() -> None:
    # Only the direction (1, 1) is uncertain, with variance 2 along the unit vector.
    P = np.ones((2, 2))
    along = normalised_square(np.array([2.0, 2.0]), P)
    assert (along.value, along.dof, along.outside) == (pytest.approx(4.0), 1, False)
    across = normalised_square(np.array([1.0, -1.0]), P)
    assert (across.value, across.dof, across.outside) == (pytest.approx(0.0, abs=1e-12), 1, True)


def test_a_landmark_that_was_called_exact_and_is_not_is_said() -> None:
    found = normalised_square(np.array([1.0, 0.1]), np.diag([1.0, 0.0]))
    assert (found.value, found.dof, found.outside) == (1.0, 1, True)
    assert normalised_square(np.array([1.0, 0.0]), np.diag([1.0, 0.0])).outside is False
    nothing = normalised_square(np.array([0.5]), np.zeros((1, 1)))
    assert (nothing.dof, nothing.outside) == (0, True)


def test_pose_error_is_in_the_axes_of_the_target_and_uncoupled() -> None:
    T = geometry.exp_se3(np.array([1.0, 2.0, 30.0, 0.4, -0.2, 0.9]))
    true = T.copy()
    true[:3, :3] = T[:3, :3] @ geometry.exp_se3(np.array([0.0, 0.0, 0.0, 0.0, 0.02, 0.0]))[:3, :3]
    true[:3, 3] = T[:3, 3] + T[:3, :3] @ [0.3, 0.0, 0.0]
    P = np.diag([0.09, 1e-9, 1e-9, 1e-9, 4e-4, 1e-9])
    assert pose_normalised_square(T, true, P).value == pytest.approx(2.0)


def test_model_eq_19_uses_names_and_the_full_covariance() -> None:
    P = np.eye(6)
    P[0, 3] = P[3, 0] = 0.5
    estimated = Target(name="t", landmarks=("a", "b"), positions=np.array([[1.0, 0, 0], [1.0, 0, 0]]), covariance=P)
    true = Target(name="t", landmarks=("b", "a"), positions=np.zeros((2, 3)), covariance=np.zeros((6, 6)))
    found = model_normalised_square(estimated, true)
    assert found is not None
    # [1 1] inv([1 .5; .5 1]) [1 1]^T = 2 / 1.5
    assert (found.value, found.dof) == (pytest.approx(4.0 / 3.0), 6)
    # Only b is common: its own block counts.
    only_b = Target(name="t", landmarks=("b",), positions=np.zeros((1, 3)), covariance=np.zeros((3, 3)))
    found = model_normalised_square(estimated, only_b)
    assert found is not None
    assert (found.value, found.dof) == (pytest.approx(1.0), 3)


@pytest.mark.parametrize("probability", [0.95, 0.999])
def test_band_eq_20_against_the_closed_form_of_two_dof(probability: float) -> None:
    tail = (1.0 - probability) / 2.0
    band = chi_square_band(2, probability)
    assert band.lower == pytest.approx(-2.0 * math.log(1.0 - tail) / 2.0)
    assert band.upper == pytest.approx(-2.0 * math.log(tail) / 2.0)


def test_band_of_many_samples_closes_on_one() -> None:
    # Wilson and Hilferty: half width about 1.96 sqrt(2 / D) at 95 %.
    band = chi_square_band(60_000, 0.95)
    assert band.upper - 1.0 == pytest.approx(1.96 * math.sqrt(2.0 / 60_000), rel=0.01)
    assert math.isnan(chi_square_band(0, 0.95).lower)


def test_pooled_samples() -> None:
    samples = [
        NormalisedSquare(value=6.0, dof=6, outside=False),
        None,
        NormalisedSquare(value=100.0, dof=4, outside=True),
    ]
    pooled = nees(samples)
    assert pooled is not None
    assert pooled.per_dof == 10.6
    assert (pooled.n_samples, pooled.dof, pooled.n_outside, pooled.share_inside_95) == (2, 10, 1, 0.5)
    assert pooled.values == pytest.approx(np.array([1.0, np.nan, 25.0]), nan_ok=True)
    assert pooled.band999_one.upper > pooled.band999.upper > pooled.band95.upper > 1.0
    assert nees([None]) is None


def test_the_band_holds_for_errors_drawn_from_the_covariance() -> None:
    rng = np.random.default_rng(11)
    A = rng.normal(size=(6, 6)) * np.array([10.0, 10, 10, 0.01, 0.01, 0.01])[:, None]
    P = A @ A.T
    pooled = nees([normalised_square(A @ rng.normal(size=6), P) for _ in range(400)])
    assert pooled is not None
    assert pooled.band999.holds(pooled.per_dof)
    # 95 % of 400, standard deviation 4.4 samples; 99.9 % of the draws lie within 3.3 of it.
    assert abs(pooled.share_inside_95 - 0.95) < 3.3 * math.sqrt(0.95 * 0.05 / 400)
    overconfident = nees([normalised_square(A @ rng.normal(size=6), P / 1.5) for _ in range(400)])
    assert overconfident is not None
    assert not overconfident.band999.holds(overconfident.per_dof)
