# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The geometry of a training crop: a view from anywhere in the flight envelope, cut out as a detector cuts it out."""

from dataclasses import dataclass, field, replace

import numpy as np

from fairlead import geometry
from fairlead.render.viewpoints import direction, look_at
from fairlead.types import Camera, Matrix3, Matrix4, Points3

LEAST_PX = 24
"""No crop is drawn in fewer pixels."""
PAD = 1.25
"""Side of a crop in units of the larger side of the landmarks' box, before it is varied."""


@dataclass(frozen=True, kw_only=True)
class Envelope:
    """Where the camera may be, about the middle of the landmarks."""

    ranges_m: tuple[float, float]
    elevations_deg: tuple[float, float]
    R_level_target: Matrix3 = field(default_factory=lambda: np.eye(3))
    """Target axes -> axes whose z is up as the target is usually held; elevations are counted from there."""
    roll_deg: float = 6.0
    """Of the camera about its axis, one standard deviation."""


@dataclass(frozen=True, kw_only=True, eq=False)
class CropView:
    """One crop: a camera of its own."""

    camera: Camera
    T_camera_target: Matrix4
    native: Camera
    """The same view in as many pixels as the flight's camera has for it, at most those of the crop."""


def draw_view(X: Points3, camera: Camera, envelope: Envelope, size: int, rng: np.random.Generator) -> CropView:
    """Range in equal ratios, elevation, azimuth, roll, place in the image, scale 0.6 to 1.4, shift 15 % (or 50 %)."""
    low, high = envelope.ranges_m
    range_m = float(np.exp(rng.uniform(np.log(low), np.log(high))))
    elevation = np.radians(rng.uniform(*envelope.elevations_deg))
    middle = 0.5 * (X.min(axis=0) + X.max(axis=0))
    middle = envelope.R_level_target @ middle
    eye = middle + range_m * direction(float(rng.uniform(0.0, 2.0 * np.pi)), float(elevation))
    aside = np.append(0.12 * rng.standard_normal(2), np.radians(envelope.roll_deg) * rng.standard_normal())
    turn = np.eye(4)
    turn[:3, :3] = geometry.exp_so3(aside)
    level = np.eye(4)
    level[:3, :3] = envelope.R_level_target
    T = turn @ look_at(eye[None], middle)[0] @ level
    pixels = geometry.project(replace(camera, model="pinhole", distortion=np.zeros(0)), geometry.transform(T, X))
    box_low, box_high = np.nanmin(pixels, axis=0), np.nanmax(pixels, axis=0)
    side = PAD * float((box_high - box_low).max()) / float(np.exp(rng.uniform(np.log(0.6), np.log(1.4))))
    reach = 0.5 if rng.random() < 0.1 else 0.15
    corner = 0.5 * (box_low + box_high) + rng.uniform(-reach, reach, 2) * side - 0.5 * side
    cut = crop_camera(camera, corner, side, size)
    native = crop_camera(camera, corner, side, max(LEAST_PX, round(side))) if side < size else cut
    return CropView(camera=cut, T_camera_target=T, native=native)


def behind_camera(T_camera_target: Matrix4, T_world_target: Matrix4) -> Matrix4:
    """The motion of the target, level and in its own frame, that takes it behind a camera that looks at it."""
    T_world_camera = T_world_target @ geometry.inverse(T_camera_target)
    d_world = T_world_camera[:3, 3] - T_world_target[:3, 3]
    d_world = (2.0 + 3000.0 / np.linalg.norm(d_world)) * d_world * [1.0, 1.0, 0.0]
    away = np.eye(4)
    away[:3, 3] = T_world_target[:3, :3].T @ d_world
    return away


def crop_camera(camera: Camera, corner: np.ndarray, side: float, size: int) -> Camera:
    """The camera that sees the square of `side` px whose top-left **corner** (not centre) is given, in `size` px.

    docs/rendering.md eq. (4): u' + 1/2 = (u - corner) size / side.
    """
    scale = size / side
    K = camera.K.copy()
    K[0, 0] *= scale
    K[1, 1] *= scale
    K[:2, 2] = (camera.K[:2, 2] - corner) * scale - 0.5
    return Camera(name="crop", width=size, height=size, model="pinhole", K=K, distortion=np.zeros(0))
