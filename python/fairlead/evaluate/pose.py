# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Errors of single poses, docs/metrics.md eq. (2)-(4). Arrays of poses in, one number per pose out."""

import numpy as np

from fairlead.evaluate.summary import Series
from fairlead.types import Points3, Poses


def rotation_error_deg(T_estimated: Poses, T_true: Poses) -> Series:
    """Angle of R_est^T R_true [deg], docs/metrics.md eq. (2).

    atan2 of sine and cosine, so that neither small angles nor those near 180 deg lose digits. NaN poses give NaN.
    """
    R = np.swapaxes(T_estimated[:, :3, :3], 1, 2) @ T_true[:, :3, :3]
    doubled_sine = np.stack([R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]], axis=1)
    cosine = 0.5 * (np.trace(R, axis1=1, axis2=2) - 1.0)
    return np.degrees(np.arctan2(0.5 * np.linalg.norm(doubled_sine, axis=1), cosine))


def translation_error_m(T_estimated: Poses, T_true: Poses) -> Series:
    """|t_est - t_true| [m]: the target's origin in camera axes, docs/metrics.md eq. (3)."""
    return np.linalg.norm(T_estimated[:, :3, 3] - T_true[:, :3, 3], axis=1)


def range_m(T_true: Poses) -> Series:
    """|t|: distance from the camera to the target's origin [m]."""
    return np.linalg.norm(T_true[:, :3, 3], axis=1)


def camera_positions(T_camera_target: Poses) -> Points3:
    """c = -R^T t: where the camera is in the target frame [m], docs/metrics.md eq. (4)."""
    R, t = T_camera_target[:, :3, :3], T_camera_target[:, :3, 3]
    return -np.einsum("kji,kj->ki", R, t)


def position_error_m(T_estimated: Poses, T_true: Poses) -> Series:
    """|c_est - c_true| [m], docs/metrics.md eq. (4)."""
    return np.linalg.norm(camera_positions(T_estimated) - camera_positions(T_true), axis=1)
