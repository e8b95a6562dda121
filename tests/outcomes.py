# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Estimates and views made by hand, for tests of the sinks."""

import numpy as np

from fairlead.types import Estimate, View


def estimate(T: np.ndarray, covariance: np.ndarray | None = None, **changes: object) -> Estimate:
    S = np.diag([1e-6, 2e-6, 3e-6, 1e-5, 2e-5, 3e-5]) if covariance is None else covariance
    fields: dict[str, object] = {
        "frame": 0,
        "stamp_ns": 0,
        "status": "tracking",
        "reason": "",
        "T_camera_target": T,
        "covariance": S,
        "n_inliers": 16,
        "reprojection_rms_px": 0.1,
        "information_gained": 0.0,
        "reset_counter": 0,
        "inliers": (),
    }
    return Estimate(**(fields | changes))  # pyright: ignore[reportArgumentType]


def lost() -> Estimate:
    nan = np.full((4, 4), np.nan)
    return estimate(nan, np.full((6, 6), np.nan), status="lost", reason="too_few", n_inliers=0)


def no_view() -> View:
    return View(frame=0, stamp_ns=0, landmarks=(), pixels=np.empty((0, 2)), covariances=np.empty((0, 2, 2)))
