# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""EPnP of many views of one model, with the checks of docs/baselines.md section 1 on all of them at once."""

import numpy as np
from jaxtyping import Float64
from scipy.spatial.transform import Rotation

from fairlead.geometry import project
from fairlead.opencv.pnp import MIN_POINTS, ideal_pixels
from fairlead.types import Camera, Points3, Poses


def epnp_views(X_target: Points3, pixels: Float64[np.ndarray, "k n 2"], camera: Camera) -> Poses:
    """`epnp` of each view, with less to be done for each in Python.

    Parameters
    ----------
    X_target : (n, 3) landmarks, neither coplanar nor on a line [m]
    pixels : (k, n, 2) where they are seen, finite [px]

    Returns
    -------
    (k, 4, 4) T_camera_target; NaN where the solver fails, or its answer has a landmark behind the camera, or explains
    the view worse than one point would.
    """
    import cv2

    if len(X_target) < MIN_POINTS or pixels.shape[1:] != (len(X_target), 2):
        raise ValueError(
            f"EPnP: expected (n >= 4, 3) points and (k, n, 2) pixels, got {X_target.shape}, {pixels.shape}"
        )
    centre = X_target.mean(axis=0)
    X, K = X_target - centre, camera.K.copy()
    ideal = ideal_pixels(camera, pixels.reshape(-1, 2)).reshape(pixels.shape)
    rotations = np.full((len(pixels), 3), np.nan)
    translations = np.full((len(pixels), 3), np.nan)
    for k in np.flatnonzero(np.isfinite(ideal).all(axis=(1, 2))):
        try:
            ok, rotation, translation = cv2.solvePnP(X, ideal[k], K, None, flags=cv2.SOLVEPNP_EPNP)
        except cv2.error:
            continue
        if ok:
            rotations[k], translations[k] = rotation[:, 0], translation[:, 0]
    T = _poses(rotations, translations, centre)
    T[~_plausible(T, X_target, pixels, camera)] = np.nan
    return T


def _poses(rotations: np.ndarray, translations: np.ndarray, centre: np.ndarray) -> Poses:
    """T_camera_target of the model about its own origin from rotation vectors and the positions of its centre."""
    finite = np.isfinite(rotations).all(axis=1) & np.isfinite(translations).all(axis=1)
    T = np.full((len(rotations), 4, 4), np.nan)
    R = Rotation.from_rotvec(rotations[finite]).as_matrix()
    T[finite] = np.eye(4)
    T[finite, :3, :3] = R
    T[finite, :3, 3] = translations[finite] - R @ centre
    return T


def _plausible(T: Poses, X_target: Points3, pixels: np.ndarray, camera: Camera) -> np.ndarray:
    """Every landmark in front, and a residual below the spread of the pixels about their mean."""
    p = np.einsum("kij,nj->kni", T[:, :3, :3], X_target) + T[:, None, :3, 3]
    residuals = project(camera, p.reshape(-1, 3)).reshape(pixels.shape) - pixels
    spread = ((pixels - pixels.mean(axis=1, keepdims=True)) ** 2).mean(axis=(1, 2))
    with np.errstate(invalid="ignore"):
        return (residuals**2).mean(axis=(1, 2)) < spread
