# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A target of seven coloured spots, drawn where a camera sees them; the networks of networks.py find it."""

from dataclasses import dataclass

import numpy as np

from fairlead import geometry
from fairlead.types import Camera, Matrix4, Target
from tests.unit.detect.networks import COLOURS, NAMES

X = np.array(
    [[0, 0, 0], [10, 0, 1], [10, 6, 0], [0, 6, 2], [4, 2, 4], [7, 4, -3], [2, 5, -2]],
    dtype=np.float64,
)
"""Metres."""
SPOT_PX = 0.35
"""Radius of a spot at 1 m, in units of the focal length [m]."""


def spots_target(sigma_m: float = 0.05) -> Target:
    return Target(name="spots", landmarks=NAMES, positions=X, covariance=sigma_m**2 * np.eye(3 * len(X)))


def wide_camera(width: int = 640, height: int = 480) -> Camera:
    """With a lens that moves a pixel in the corner by about 20 px."""
    K = np.array([[700.0, 0.0, 0.5 * width - 0.5], [0.0, 710.0, 0.5 * height - 0.5], [0.0, 0.0, 1.0]])
    distortion = np.array([-0.15, 0.02, 1e-3, -5e-4, 0.0])
    return Camera(name="wide", width=width, height=height, model="plumb_bob", K=K, distortion=distortion)


def seen_from(depth_m: float, *, aside_m: tuple[float, float] = (0.0, 0.0), turn_rad: float = 0.3) -> Matrix4:
    """T_camera_target with the target's middle at this place."""
    T = np.eye(4)
    T[:3, :3] = geometry.exp_so3(np.array([0.4, turn_rad, 0.2]))
    T[:3, 3] = np.array([*aside_m, depth_m]) - T[:3, :3] @ X.mean(axis=0)
    return T


@dataclass(frozen=True, kw_only=True, eq=False)
class Picture:
    image: np.ndarray
    """Blue, green, red."""
    pixels: np.ndarray
    """Where the spots are."""


def draw(camera: Camera, T_camera_target: Matrix4 | None, *, hidden: frozenset[str] = frozenset()) -> Picture:
    """Spots on dark grey; None: no target."""
    light = np.full((camera.height, camera.width, 3), 12.0)
    if T_camera_target is None:
        return Picture(image=light.astype(np.uint8), pixels=np.full((len(X), 2), np.nan))
    p_camera = geometry.transform(T_camera_target, X)
    pixels = geometry.project(camera, p_camera)
    for name, colour, z, depth in zip(NAMES, COLOURS, pixels, p_camera[:, 2], strict=True):
        if name not in hidden and np.isfinite(z).all():
            spot(light, z, camera.K[0, 0] * SPOT_PX / depth, colour)
    return Picture(image=np.clip(np.round(light), 0, 255).astype(np.uint8), pixels=pixels)


def spot(light: np.ndarray, z: np.ndarray, radius: float, colour: np.ndarray) -> None:
    """An anti-aliased disc; `colour` is red, green, blue from 0 to 1."""
    reach = int(radius) + 3
    left, top = (max(0, int(c) - reach) for c in z)
    part = light[top : max(0, int(z[1]) + reach), left : max(0, int(z[0]) + reach)]
    if part.size == 0:
        return
    v, u = np.mgrid[top : top + part.shape[0], left : left + part.shape[1]]
    cover = np.clip(radius - np.hypot(u - z[0], v - z[1]) + 0.5, 0.0, 1.0)[..., None]
    part += cover * (255.0 * colour[::-1] - part)
