# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Pose of one view by OpenCV's solvers, each answer checked, docs/baselines.md section 1.

OpenCV reports success with NaN, with the target behind the camera and with reflections; such answers never leave here.
Lenses are taken out first: the solvers see the ideal pixels K ray / ray_z of a pinhole camera with the same K.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fairlead.geometry import exp_so3, log_so3, project, transform, unproject
from fairlead.types import Camera, Matrix4, Pixels, Points3, Vector3, is_rigid

MIN_POINTS = 4


@dataclass(frozen=True, kw_only=True, eq=False)
class PnpSolution:
    """A pose that passed the checks."""

    T_camera_target: Matrix4
    reprojection_rms_px: float
    """Root mean square of pi(T X) - z over the landmarks and both coordinates [px], lens included."""


def epnp(X_target: Points3, pixels: Pixels, camera: Camera) -> tuple[PnpSolution, ...]:
    """EPnP. Source: Lepetit, Moreno-Noguer, Fua 2009, EPnP: an accurate O(n) solution to the PnP problem.

    Parameters
    ----------
    X_target : (n, 3) landmarks, not coplanar [m]
    pixels : (n, 2) where they are seen [px]

    Returns
    -------
    One solution, or none: fewer than four points, numbers that are not finite, pixels beyond the lens, points on a
    line, a failure of the solver, or an answer that fails a check.
    """
    import cv2

    return _solve(cv2.SOLVEPNP_EPNP, X_target, pixels, camera)


def sqpnp(X_target: Points3, pixels: Pixels, camera: Camera) -> tuple[PnpSolution, ...]:
    """SQPnP, for any shape, planar too. Source: Terzakis and Lourakis 2020. Arguments and failures as `epnp`."""
    import cv2

    return _solve(cv2.SOLVEPNP_SQPNP, X_target, pixels, camera)


def ippe(X_target: Points3, pixels: Pixels, camera: Camera) -> tuple[PnpSolution, ...]:
    """IPPE: both poses of a plane, the better one first. Source: Collins and Bartoli 2014.

    Arguments and failures as `epnp`, but the landmarks must be coplanar; none for others.
    """
    import cv2

    return _solve(cv2.SOLVEPNP_IPPE, X_target, pixels, camera)


def refine(
    X_target: Points3, pixels: Pixels, camera: Camera, T_camera_target: Matrix4, iterations: int = 20
) -> tuple[PnpSolution, ...]:
    """Minimise the sum of |pi(T X) - z|^2 over T from a first guess, in ideal pixels, by OpenCV's LM.

    The arguments are copied: OpenCV changes its own in place. One solution, or none as in `epnp`.
    """
    import cv2

    usable = _usable(X_target, pixels, camera)
    if usable is None or not is_rigid(T_camera_target):
        return ()
    centre = X_target.mean(axis=0)
    rotation = log_so3(T_camera_target[:3, :3]).reshape(3, 1).copy()
    translation = (T_camera_target[:3, :3] @ centre + T_camera_target[:3, 3]).reshape(3, 1)
    criteria = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, iterations, 1e-10)
    try:
        found = cv2.solvePnPRefineLM(
            X_target - centre, usable.copy(), camera.K.copy(), None, rotation, translation, criteria
        )
    except cv2.error:
        return ()
    return _checked([found], centre, X_target, pixels, camera)


def ideal_pixels(camera: Camera, pixels: Pixels) -> Pixels:
    """Where a pinhole camera with the same K would see them: K ray / ray_z [px]. NaN where the lens has no ray."""
    if camera.model == "pinhole":
        return pixels.copy()
    rays = unproject(camera, pixels)
    with np.errstate(all="ignore"):
        plane = np.where(rays[:, 2:] > 0.0, rays[:, :2] / rays[:, 2:], np.nan)
    return plane * np.diag(camera.K)[:2] + camera.K[:2, 2]


def _usable(X_target: Points3, pixels: Pixels, camera: Camera) -> Pixels | None:
    """The ideal pixels, or None where no solver should be asked."""
    if X_target.ndim != 2 or X_target.shape[1] != 3 or pixels.shape != (len(X_target), 2):
        raise ValueError(f"PnP: expected (n, 3) points and (n, 2) pixels, got {X_target.shape} and {pixels.shape}")
    if len(X_target) < MIN_POINTS or not (np.isfinite(X_target).all() and np.isfinite(pixels).all()):
        return None
    ideal = ideal_pixels(camera, pixels)
    spread = np.linalg.svd(X_target - X_target.mean(axis=0), compute_uv=False)
    on_a_line = not spread[1] > 1e-6 * spread[0]
    return None if on_a_line or not np.isfinite(ideal).all() else ideal


def _solve(method: int, X_target: Points3, pixels: Pixels, camera: Camera) -> tuple[PnpSolution, ...]:
    import cv2

    usable = _usable(X_target, pixels, camera)
    if usable is None:
        return ()
    centre = X_target.mean(axis=0)
    try:
        # About the centroid, here and below: far from its origin a model loses digits.
        _, rotations, translations, *_ = cv2.solvePnPGeneric(
            X_target - centre, usable.copy(), camera.K.copy(), None, flags=method
        )
    except cv2.error:
        return ()
    return _checked(list(zip(rotations, translations, strict=True)), centre, X_target, pixels, camera)


def _checked(
    raw: Sequence[tuple[np.ndarray, np.ndarray]], centre: Vector3, X_target: Points3, pixels: Pixels, camera: Camera
) -> tuple[PnpSolution, ...]:
    """Those answers that are rigid, see every landmark in front, and explain the image better than one point would.

    Rotation and translation are those of a target frame about the landmarks' centre.
    """
    spread_px = float(np.sqrt(((pixels - pixels.mean(axis=0)) ** 2).mean()))
    solutions: list[PnpSolution] = []
    for rotation, translation in raw:
        T = np.eye(4)
        T[:3, :3] = exp_so3(np.ravel(rotation).astype(np.float64))
        T[:3, 3] = np.ravel(translation) - T[:3, :3] @ centre
        if not is_rigid(T):
            continue
        residuals = project(camera, transform(T, X_target)) - pixels
        rms = float(np.sqrt((residuals**2).mean()))
        if np.isfinite(rms) and rms < spread_px:
            solutions.append(PnpSolution(T_camera_target=T, reprojection_rms_px=rms))
    return tuple(sorted(solutions, key=lambda solution: solution.reprojection_rms_px))
