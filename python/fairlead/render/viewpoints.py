# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Cameras that look at a point. Target axes with z up."""

import numpy as np

from fairlead.types import Points3, Poses, Vector3


def look_at(centres: Points3, point: Vector3) -> Poses:
    """T_camera_target of upright cameras: z towards `point`, x level and to the right, y down; (k, 4, 4).

    Straight above or below, where no direction is upright, x of the target is up. Raises ValueError for a camera at
    the point.
    """
    T = np.tile(np.eye(4), (len(centres), 1, 1))
    for k, centre in enumerate(centres):
        forward = point - centre
        length = float(np.linalg.norm(forward))
        if length == 0.0:
            raise ValueError("look_at: the camera is at the point that it looks at")
        forward = forward / length
        right = np.array([forward[1], -forward[0], 0.0])
        if np.linalg.norm(right) < 1e-9:
            right = np.array([0.0, -1.0, 0.0])
        right /= np.linalg.norm(right)
        R = np.stack([right, np.cross(forward, right), forward])
        T[k, :3, :3] = R
        T[k, :3, 3] = -R @ centre
    return T


def direction(azimuth_rad: float, elevation_rad: float) -> Vector3:
    """Unit vector at an azimuth from x and an elevation above the level."""
    c = np.cos(elevation_rad)
    return np.array([c * np.cos(azimuth_rad), c * np.sin(azimuth_rad), np.sin(elevation_rad)])
