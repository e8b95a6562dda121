# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Camera -> OpenGL. The half pixel between both conventions lives here: docs/rendering.md section 2."""

import numpy as np
from jaxtyping import Float64

from fairlead.render.errors import RenderError
from fairlead.types import Camera, Matrix3, Matrix4, Vector3

ClipCorners = Float64[np.ndarray, "n 4"]


def check_pinhole(camera: Camera) -> None:
    """Raises RenderError for a camera with distortion: images are rendered as through a pinhole."""
    if camera.model == "equidistant" or np.any(camera.distortion != 0.0):
        raise RenderError(f"camera {camera.name}: expected no distortion, rendered images are those of a pinhole")


def clip_of_camera(camera: Camera, near_m: float, far_m: float) -> Matrix4:
    """Camera axes -> clip coordinates, docs/rendering.md eq. (3): row 0 of the buffer is the top row of the image.

    Pixel (0, 0), the centre of the top-left pixel for us, lies half a pixel inside the corner (-1, -1) of clip space.
    """
    W, H, K = camera.width, camera.height, camera.K
    matrix = np.zeros((4, 4))
    matrix[0, 0], matrix[0, 2] = 2.0 * K[0, 0] / W, 2.0 * (K[0, 2] + 0.5) / W - 1.0
    matrix[1, 1], matrix[1, 2] = 2.0 * K[1, 1] / H, 2.0 * (K[1, 2] + 0.5) / H - 1.0
    matrix[2, 2], matrix[2, 3] = (far_m + near_m) / (far_m - near_m), -2.0 * far_m * near_m / (far_m - near_m)
    matrix[3, 2] = 1.0
    return matrix


def rays_of_clip(camera: Camera, R_camera_world: Matrix3) -> Matrix3:
    """Clip coordinates (x, y, 1) -> ray in world axes of depth 1: the inverse of clip_of_camera."""
    plane = clip_of_camera(camera, 1.0, 2.0)[np.ix_([0, 1, 3], [0, 1, 2])]
    return R_camera_world.T @ np.linalg.inv(plane)


def light_of_world(sun: Vector3, centre: Vector3, radius: float) -> Matrix4:
    """World axes -> clip coordinates of a parallel light that covers a sphere."""
    side = np.cross(sun, [0.0, 0.0, 1.0] if abs(sun[2]) < 0.99 else [1.0, 0.0, 0.0])
    side /= np.linalg.norm(side)
    R = np.stack([side, np.cross(sun, side), -sun]) / radius
    matrix = np.eye(4)
    matrix[:3, :3] = R
    matrix[:3, 3] = -R @ centre
    return matrix


def unit_cube() -> Matrix4:
    """Clip coordinates -1..1 -> texture coordinates 0..1."""
    matrix = 0.5 * np.eye(4)
    matrix[:3, 3] = 0.5
    matrix[3, 3] = 1.0
    return matrix
