# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Where the camera is and where it looks. Target axes: x forward, y to port, z up, origin at the stern."""

import numpy as np

from fairlead.types import Points3, Poses, Vector3


def box_centre(X: Points3) -> Vector3:
    """Middle of the axis-parallel box of the landmarks [m]: what the camera looks at."""
    return 0.5 * (X.min(axis=0) + X.max(axis=0))


def arc_centres(azimuths_rad: np.ndarray, range_m: float, elevation_rad: float) -> Points3:
    """c = r (cos e cos a, cos e sin a, sin e): camera positions on a circle about the target's vertical axis.

    Parameters
    ----------
    azimuths_rad : (k,) about z from the bow's direction; pi is dead astern
    range_m : distance from the target's origin
    elevation_rad : of the camera above the water, seen from the origin

    Returns
    -------
    (k, 3) [m], target frame.
    """
    level = range_m * np.cos(elevation_rad)
    return np.stack(
        [
            level * np.cos(azimuths_rad),
            level * np.sin(azimuths_rad),
            np.full(len(azimuths_rad), range_m * np.sin(elevation_rad)),
        ],
        axis=1,
    )


def look_at(centres: Points3, point: Vector3) -> Poses:
    """T_camera_target of upright cameras at `centres` that look at `point`.

    Camera axes: z towards the point, x level and to the right, y down. Rows of R are these axes in the target frame,
    t = -R c.

    Returns
    -------
    (k, 4, 4).

    Raises ValueError if a camera is at the point or straight above or below it.
    """
    forward = point - centres
    distance = np.linalg.norm(forward, axis=1, keepdims=True)
    right = np.stack([forward[:, 1], -forward[:, 0], np.zeros(len(centres))], axis=1)
    level = np.linalg.norm(right, axis=1, keepdims=True)
    if np.any(distance == 0.0) or np.any(level <= 1e-9 * distance):
        raise ValueError("look_at: expected cameras that are not straight above or below the point")
    forward, right = forward / distance, right / level
    R = np.stack([right, np.cross(forward, right), forward], axis=1)
    T = np.zeros((len(centres), 4, 4))
    T[:, :3, :3] = R
    T[:, :3, 3] = -np.einsum("kij,kj->ki", R, centres)
    T[:, 3, 3] = 1.0
    return T
