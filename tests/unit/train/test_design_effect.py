# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Errors that landmarks share are told from those that each has for itself."""

import numpy as np
import pytest

from fairlead import geometry
from fairlead.design_effect import pose_jacobian
from fairlead.geometry import exp_se3
from fairlead.io.network_card import Calibration
from fairlead.train.alike import measured_design_effect
from fairlead.train.findings import Findings
from fairlead.types import Camera

FOCAL_PX, LANDMARKS, PICTURES = 900.0, 15, 300
CAMERA = Camera(
    name="c", width=640, height=480, model="pinhole", distortion=np.zeros(0),
    K=np.array([[FOCAL_PX, 0.0, 320.0], [0.0, FOCAL_PX, 240.0], [0.0, 0.0, 1.0]]),
)  # fmt: skip
T_CAMERA_TARGET = geometry.inverse(exp_se3(np.array([3.0, -2.0, -40.0, 0.1, -0.2, 0.3])))


def findings(kappa: float, sigma: float = 1.5, seed: int = 0) -> Findings:
    """e = n + J d with d ~ N(0, (kappa - 1) (J^T S^-1 J)^-1): the pose errs kappa times as much, squared."""
    rng = np.random.default_rng(seed)
    X = rng.uniform(-5.0, 5.0, (LANDMARKS, 3))
    J = pose_jacobian(CAMERA, T_CAMERA_TARGET, X)
    flat = J.reshape(-1, 6) / sigma
    spread = np.linalg.cholesky(np.linalg.inv(flat.T @ flat))
    d = np.sqrt(kappa - 1.0) * rng.standard_normal((PICTURES, 6)) @ spread.T
    error = sigma * rng.standard_normal((PICTURES, LANDMARKS, 2)) + np.einsum("nai,ki->kna", J, d)
    m = PICTURES * LANDMARKS
    return Findings(
        condition=np.zeros(m, int), picture=np.repeat(np.arange(PICTURES), LANDMARKS),
        landmark=np.tile(np.arange(LANDMARKS), PICTURES), visibility=np.full(m, 2), error=error.reshape(m, 2),
        cholesky=np.tile([np.log(sigma), np.log(sigma), 0.0], (m, 1)), visible=np.ones(m), unit=np.ones(m),
        range_m=np.full(m, 40.0), azimuth_deg=np.zeros(m), jacobian=np.tile(J, (PICTURES, 1, 1)),
    )  # fmt: skip


def test_errors_of_their_own_have_none() -> None:
    """The mean of 1800 squares is good to 3 %."""
    assert measured_design_effect(findings(1.0), Calibration(), LANDMARKS) == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("factor", [1.0, 4.0])
def test_what_landmarks_share_is_found_whatever_the_covariances_say(factor: float) -> None:
    """s grows by (2n - 6 + 6 kappa) / 2n, since shared errors are errors as well."""
    kappa, n = 3.0, LANDMARKS
    found = measured_design_effect(findings(kappa), Calibration(scale=(factor,)), n)
    assert found == pytest.approx(kappa / (1.0 + 6.0 * (kappa - 1.0) / (2.0 * n)), rel=0.1)


def test_pictures_of_few_landmarks_say_nothing() -> None:
    rows = findings(3.0)
    assert np.isnan(measured_design_effect(rows.where(rows.landmark < 5), Calibration(), LANDMARKS))
