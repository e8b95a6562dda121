# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Pose of one view on a model that is taken as exact, docs/baselines.md sections 1 and 2."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from fairlead import opencv
from fairlead.baselines.observed import Observed
from fairlead.geometry import adjoint, exp_se3, project, transform
from fairlead.types import Camera, Estimate, Matrix4, Matrix6, PixelCovariances, Points3, View

NEARLY_FLAT = 0.1
"""Thickness over breadth of the landmarks below which the solvers for planes are asked too [-]."""
FLAT = 1e-3
"""Below this IPPE, which needs a plane, is asked."""
_STRAIGHT = 1e-6
_STEP = 1e-6


@dataclass(frozen=True, kw_only=True, eq=False)
class SingleView:
    """A checked pose."""

    T_camera_target: Matrix4
    covariance: Matrix6
    """Of xi in T Exp(xi), of the told pixel errors alone."""
    reprojection_rms_px: float
    """Over both coordinates."""


def solve_view(
    seen: Observed, X_target: Points3, camera: Camera, *, refined: bool
) -> SingleView | Literal["too_few", "degenerate"]:
    """EPnP, or whichever of EPnP, IPPE and SQPnP explains flat landmarks best; the reason if there is no pose.

    Parameters
    ----------
    seen : observations
    X_target : (n, 3) all landmarks [m]
    refined : minimise the reprojection error from there
    """
    if len(seen.index) < opencv.MIN_POINTS:
        return "too_few"
    X = X_target[seen.index]
    size = np.linalg.svd(X - X.mean(axis=0), compute_uv=False)
    if not size[1] > _STRAIGHT * size[0]:
        return "degenerate"
    solutions = opencv.epnp(X, seen.pixels, camera)
    flatness = size[2] / size[1]
    if flatness < NEARLY_FLAT:
        solutions += opencv.sqpnp(X, seen.pixels, camera)
    if flatness < FLAT:
        solutions += opencv.ippe(X, seen.pixels, camera)
    if refined:
        solutions += tuple(
            better for s in solutions for better in opencv.refine(X, seen.pixels, camera, s.T_camera_target)
        )
    if not solutions:
        return "degenerate"
    best = min(solutions, key=lambda solution: solution.reprojection_rms_px)
    covariance = pose_covariance(camera, X, best.T_camera_target, seen.covariances)
    if covariance is None:
        return "degenerate"
    return SingleView(
        T_camera_target=best.T_camera_target,
        covariance=covariance,
        reprojection_rms_px=best.reprojection_rms_px,
    )


def pose_covariance(
    camera: Camera, X_target: Points3, T_camera_target: Matrix4, covariances: PixelCovariances
) -> Matrix6 | None:
    """(sum_j J_j^T S_j^-1 J_j)^-1 with J = d pi(T Exp(xi) X) / d xi, docs/baselines.md eq. (1).

    The landmarks are taken as exact. None where the pose is not determined. J by central differences: relative error
    about 1e-9, steps are in units of the landmarks' spread, about their middle, wherever the target has its origin.
    """
    to_middle = np.eye(4)
    to_middle[:3, 3] = X_target.mean(axis=0)
    X, T_camera_middle = X_target - X_target.mean(axis=0), T_camera_target @ to_middle
    scale = np.ones(6)
    scale[:3] = np.sqrt((X**2).sum(axis=1).mean())
    moves = [T_camera_middle @ exp_se3(sign * _STEP * scale * axis) for axis in np.eye(6) for sign in (1.0, -1.0)]
    points = np.concatenate([transform(T, X) for T in moves])
    pixels = project(camera, points).reshape(6, 2, len(X_target), 2)
    J = ((pixels[:, 0] - pixels[:, 1]) / (2.0 * _STEP)).transpose(1, 2, 0)
    H = np.einsum("nia,nij,njb->ab", J, np.linalg.inv(covariances), J)
    if not np.isfinite(H).all():
        return None
    values, vectors = np.linalg.eigh(H)
    if not values[0] > 1e-12 * values[-1]:
        return None
    to_target = adjoint(to_middle) * scale
    return to_target @ ((vectors / values) @ vectors.T) @ to_target.T


def tracked(view: View, seen: Observed, pose: SingleView, landmarks: tuple[str, ...]) -> Estimate:
    """The estimate with status tracking of a checked pose."""
    return Estimate(
        frame=view.frame,
        stamp_ns=view.stamp_ns,
        status="tracking",
        reason="",
        T_camera_target=pose.T_camera_target,
        covariance=pose.covariance,
        n_inliers=len(seen.index),
        reprojection_rms_px=pose.reprojection_rms_px,
        information_gained=0.0,
        reset_counter=0,
        inliers=tuple(landmarks[j] for j in seen.index),
    )
