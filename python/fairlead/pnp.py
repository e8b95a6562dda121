# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Pose of one view among wrong matches, by the C++ core: typed wrapper, no algorithm. docs/pnp.md."""

from dataclasses import dataclass

import numpy as np

from fairlead import _core
from fairlead.geometry import project, transform
from fairlead.tracker import core_camera
from fairlead.types import Camera, Matrix4, Matrix6, PixelCovariances, Pixels, Points3

MIN_POINTS = 4
INLIER = 9.21034037197618
"""Squared whitened residual of an inlier [-]: 99 % of chi-square with two degrees of freedom."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RobustPose:
    """What RANSAC and refinement found."""

    T_camera_target: Matrix4
    information: Matrix6
    """J^T S^-1 J over the inliers, of xi in T Exp(xi)."""
    inliers: np.ndarray
    """(n,) bool."""


def robust_pose(
    X_target: Points3, pixels: Pixels, covariances: PixelCovariances, camera: Camera, *, seed: int = 0
) -> RobustPose | None:
    """The pose that most observations agree with: P3P, RANSAC, robust refinement.

    Parameters
    ----------
    X_target : (n, 3) [m]
    pixels, covariances : (n, 2) [px], (n, 2, 2) [px^2], as the camera gives them, lens included

    None for fewer than four usable observations, or no pose with four inliers in front of the camera.
    """
    definite = np.isfinite(pixels.sum(axis=1) + covariances.sum(axis=(1, 2)))
    S = np.where(definite[:, None, None], covariances, np.eye(2))
    definite &= (S[:, 0, 0] > 0.0) & (S[:, 0, 0] * S[:, 1, 1] - S[:, 0, 1] * S[:, 1, 0] > 0.0)
    if np.count_nonzero(definite) < MIN_POINTS:
        return None
    rows = np.flatnonzero(definite)
    pose, _, ok = _core.ransac(
        core_camera(camera),
        np.ascontiguousarray(X_target[rows]),
        np.arange(len(rows), dtype=np.int32),
        np.ascontiguousarray(pixels[rows]),
        np.ascontiguousarray(covariances[rows]),
        INLIER,
        seed=seed,
    )
    T, information, *_ = pose
    if not ok:
        return None
    squares = whitened_squares(X_target, pixels, S, camera, T)
    return RobustPose(T_camera_target=T, information=information, inliers=definite & (squares < INLIER))


def whitened_squares(
    X_target: Points3, pixels: Pixels, covariances: PixelCovariances, camera: Camera, T_camera_target: Matrix4
) -> np.ndarray:
    """(n,) r^T S^-1 r with r = pi(T X) - z; infinite where there is no number."""
    residuals = project(camera, transform(T_camera_target, X_target)) - pixels
    squares = np.einsum("ni,nij,nj->n", residuals, np.linalg.inv(covariances), residuals)
    return np.where(np.isfinite(squares), squares, np.inf)
