# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotations of many instants at once, and the motions made of them."""

import numpy as np
from jaxtyping import Float64

from fairlead.types import Points3, Poses, Vector3

Times = Float64[np.ndarray, "k"]
"""Instants since the start of the flight [s]."""
Rotations = Float64[np.ndarray, "k 3 3"]


def exp_rotations(phi: Points3) -> Rotations:
    """Exp of one rotation vector per row [rad], CONVENTIONS.md eq. (4)."""
    angle = np.linalg.norm(phi, axis=1)
    small = angle < 1e-8
    safe = np.where(small, 1.0, angle)
    sine = np.where(small, 1.0, np.sin(safe) / safe)
    cosine = np.where(small, 0.5, 2.0 * (np.sin(0.5 * safe) / safe) ** 2)
    half = np.zeros((len(phi), 3, 3))
    half[:, 2, 1], half[:, 0, 2], half[:, 1, 0] = phi.T
    H = half - half.transpose(0, 2, 1)
    return np.eye(3) + sine[:, None, None] * H + cosine[:, None, None] * (H @ H)


def yaw_pitch_roll(yaw: Times, pitch: Times, roll: Times) -> Rotations:
    """Rz(yaw) Ry(pitch) Rx(roll) [rad]: docs/simulate.md eq. (7)."""
    axes = np.zeros((3, len(yaw), 3))
    axes[0, :, 2], axes[1, :, 1], axes[2, :, 0] = yaw, pitch, roll
    return exp_rotations(axes[0]) @ exp_rotations(axes[1]) @ exp_rotations(axes[2])


def motions(R: Rotations, t: Points3) -> Poses:
    """(R, t) as 4 x 4 matrices."""
    T = np.zeros((len(R), 4, 4))
    T[:, :3, :3], T[:, :3, 3], T[:, 3, 3] = R, t, 1.0
    return T


def turned_about(R: Rotations, point: Vector3, shift: Points3) -> Poses:
    """p = R (X - point) + point + shift."""
    return motions(R, shift + point - R @ point)
