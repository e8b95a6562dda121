# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""How the oracle writes a view: camera centre and left rotation vector; that step in xi, docs/bound.md eq. (3)-(5)."""

import numpy as np
from scipy.spatial.transform import Rotation


def hat(v: np.ndarray) -> np.ndarray:
    """(..., 3) -> (..., 3, 3), hat(a) b = a x b."""
    out = np.zeros((*v.shape[:-1], 3, 3))
    out[..., 0, 1], out[..., 0, 2], out[..., 1, 2] = -v[..., 2], v[..., 1], -v[..., 0]
    return out - np.swapaxes(out, -1, -2)


def centre_and_rotation(T_camera_target: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """c = -R^T t and R, for (..., 4, 4)."""
    R = T_camera_target[..., :3, :3]
    return -np.einsum("...ji,...j->...i", R, T_camera_target[..., :3, 3]), R


def pose_matrix(c: np.ndarray, R: np.ndarray) -> np.ndarray:
    """[R, -R c; 0, 1] for (..., 3) and (..., 3, 3)."""
    T = np.zeros((*c.shape[:-1], 4, 4))
    T[..., :3, :3] = R
    T[..., :3, 3] = -np.einsum("...ij,...j->...i", R, c)
    T[..., 3, 3] = 1.0
    return T


def move(T_camera_target: np.ndarray, step: np.ndarray) -> np.ndarray:
    """Apply (dc, w), (k, 6): centre c + dc, rotation exp(w) R."""
    c, R = centre_and_rotation(T_camera_target)
    return pose_matrix(c + step[:, :3], Rotation.from_rotvec(step[:, 3:]).as_matrix() @ R)


def xi_from_step(T_camera_target: np.ndarray) -> np.ndarray:
    """d xi / d (dc, w), (k, 6, 6): phi = R^T w, rho = c x phi - dc, docs/bound.md eq. (5)."""
    c, R = centre_and_rotation(T_camera_target)
    Rt = np.swapaxes(R, -1, -2)
    B = np.zeros((*c.shape[:-1], 6, 6))
    B[..., :3, :3] = -np.eye(3)
    B[..., :3, 3:] = hat(c) @ Rt
    B[..., 3:, 3:] = Rt
    return B
