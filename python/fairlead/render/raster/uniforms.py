# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What the programs are told of one shot. Eye axes: those of the world, origin at the camera."""

import numpy as np

from fairlead import geometry
from fairlead.render.ocean import TILES_M, TURNS_RAD
from fairlead.render.raster.matrices import clip_of_camera, light_of_world, rays_of_clip, unit_cube
from fairlead.render.raster.model import Model, Shot
from fairlead.render.surroundings import Surroundings
from fairlead.types import Matrix4

Value = np.ndarray | float | int


def eye_of_world(shot: Shot) -> Matrix4:
    """World axes -> eye axes: a translation."""
    matrix = np.eye(4)
    matrix[:3, 3] = -shot.eye
    return matrix


def clip_of_eye_light(shot: Shot, target: Model, sun: np.ndarray) -> Matrix4:
    """Eye axes -> the sun's view of the sphere about the target."""
    T_eye_target = eye_of_world(shot) @ shot.T_world_target
    centre = geometry.transform(T_eye_target, target.centre[None])[0]
    return light_of_world(sun, centre, 1.02 * target.radius)


def depth_range(shot: Shot, target: Model) -> tuple[float, float]:
    """Nearest and farthest that any model can be [m]."""
    placed = [(target, shot.T_camera_target)]
    placed += [(model, shot.T_camera_world @ T_world_model) for model, T_world_model in shot.others]
    depths = [(geometry.transform(T, model.centre[None])[0, 2], model.radius) for model, T in placed]
    near = min(z - 1.05 * radius for z, radius in depths)
    far = max(z + 1.05 * radius for z, radius in depths)
    return max(near, 1e-3 * target.radius), max(far, 2e-3 * target.radius)


def surface_uniforms(
    shot: Shot, model: Model, T_world_model: Matrix4, surroundings: Surroundings, span: tuple[float, float]
) -> dict[str, Value]:
    """For surface.vert, with either fragment shader."""
    T_camera_model = shot.T_camera_world @ T_world_model
    return {
        "clip_of_target": (clip_of_camera(shot.camera, *span) @ T_camera_model).T,
        "eye_of_target": (eye_of_world(shot) @ T_world_model).T,
        "in_camera": T_camera_model[2, :3],
        "in_camera_z": T_camera_model[2, 3],
        "waterline": -shot.eye[2] if surroundings.kind == "sea" else -1e9,
        "inverse_size": 4.0 / model.radius,
    }


def background_uniforms(
    shot: Shot, target: Model, surroundings: Surroundings, shadow_of_eye: Matrix4
) -> dict[str, Value]:
    """For background.frag."""
    eye = shot.eye
    values: dict[str, Value] = {
        "ray_of_clip": rays_of_clip(shot.camera, shot.T_camera_world[:3, :3]).T,
        "height": max(float(eye[2]), 1e-3),
        "eye_xy": eye[:2],
        "shadow_of_eye": shadow_of_eye.T,
    }
    turned = [
        np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]]) / L for L, a in zip(TILES_M, TURNS_RAD, strict=True)
    ]
    values["into_tile"] = np.stack([matrix.T for matrix in turned])
    values["under"] = np.stack([(matrix @ eye[:2]) % 1.0 for matrix in turned])
    values |= _mirror(shot, target, surroundings)
    values |= haze(shot, surroundings)
    if surroundings.wake is not None:
        T_world_hull = shot.T_world_target if shot.T_world_wake is None else shot.T_world_wake
        T_hull_eye = geometry.inverse(T_world_hull) @ geometry.inverse(eye_of_world(shot))
        level = T_hull_eye[:2, :2] / np.linalg.norm(T_hull_eye[:2, :2], axis=1, keepdims=True)
        values["hull_of_eye"] = np.column_stack([level, level @ (eye - T_world_hull[:3, 3])[:2]]).T
        for name, wake in zip(("near_box", "far_box"), surroundings.wake, strict=True):
            x, y = wake.x, wake.y
            values[name] = np.array([x[0], y[0], 1.0 / (x[1] - x[0]), 1.0 / (y[1] - y[0])])
    return values


def haze(shot: Shot, surroundings: Surroundings) -> dict[str, Value]:
    """Radiance of the horizon at the left and the right edge of the image: what far things fade into."""
    sky, camera = surroundings.sky.radiance, shot.camera
    rows, columns = max(2, len(sky) // 10), sky.shape[1]
    values: dict[str, Value] = {"width": float(camera.width)}
    for name, u in (("haze_left", -0.5), ("haze_right", camera.width - 0.5)):
        ray = shot.T_camera_world[:3, :3].T @ np.array([(u - camera.K[0, 2]) / camera.K[0, 0], 0.0, 1.0])
        column = int(np.arctan2(ray[1], ray[0]) / (2.0 * np.pi) * columns) % columns
        spread = (column + np.arange(-columns // 64, columns // 64 + 1)) % columns
        values[name] = sky[:rows, spread].mean(axis=(0, 1))
    return values


def _mirror(shot: Shot, target: Model, surroundings: Surroundings) -> dict[str, Value]:
    """The box that the sea mirrors, and the light that comes off it."""
    low, high = target.low.copy(), target.high.copy()
    low[2] = max(low[2], 0.0)
    high[2] = low[2] + 0.6 * (high[2] - low[2])  # masts are thin
    half = np.maximum(0.5 * (high - low) * np.array([0.97, 0.9, 1.0]), 1e-3)
    box_of_target = np.eye(4)
    box_of_target[:3, :3] = np.diag(1.0 / half)
    box_of_target[:3, 3] = -0.5 * (low + high) / half
    T_target_eye = geometry.inverse(shot.T_world_target) @ geometry.inverse(eye_of_world(shot))
    sky = surroundings.sky
    side = 0.4 * sky.irradiance + 0.35 * sky.sun_irradiance * np.sqrt(max(1.0 - sky.sun_direction[2] ** 2, 0.0))
    return {"box_of_eye": (box_of_target @ T_target_eye).T, "box_colour": target.mean_colour * side / np.pi}


def shadow_of_eye(light: Matrix4) -> Matrix4:
    """Eye axes -> place and depth in the shadow map, 0..1."""
    return unit_cube() @ light
