# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The cameras of the core against OpenCV's (docs/cameras.md eq. (1)-(9)) and against the package's numpy ones."""

import cv2
import numpy as np
import pytest

from fairlead import _core, cameras
from fairlead.types import Camera, CameraModel

K = np.array([[812.0, 0.0, 655.3], [0.0, 805.0, 493.1], [0.0, 0.0, 1.0]])
WIDTH, HEIGHT = 1280, 960
LENSES: list[tuple[CameraModel, list[float]]] = [
    ("pinhole", []),
    ("plumb_bob", [-0.28, 0.09, 1.2e-3, -7e-4, -0.01]),
    ("plumb_bob", [0.11, -0.05, -2e-3, 1e-3, 0.02]),
    ("rational_polynomial", [0.45, -0.2, 1e-3, 5e-4, 0.03, 0.72, -0.15, 0.04]),
    ("equidistant", [-0.02, 0.015, -0.006, 0.0008]),
    ("equidistant", [0.0, 0.0, 0.0, 0.0]),
]
PIXEL_TOLERANCE = 1e-9
"""Rounding: 1e3 px carry 1e-13 px an operation, a few hundred operations."""


def core_camera(model: CameraModel, distortion: list[float]) -> _core.Camera:
    return _core.Camera(model, WIDTH, HEIGHT, K, np.array(distortion))


def points_in_view(seed: int, field: float = 0.7) -> np.ndarray:
    rng = np.random.default_rng(seed)
    depth = rng.uniform(0.5, 50.0, 500)
    return np.column_stack([rng.uniform(-field, field, (500, 2)) * depth[:, None], depth])


def opencv_pixels(model: CameraModel, distortion: list[float], points: np.ndarray) -> np.ndarray:
    if model == "equidistant":
        pixels, _ = cv2.fisheye.projectPoints(points[:, None], np.zeros(3), np.zeros(3), K, np.array(distortion))
    else:
        pixels, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), K, np.array(distortion or [0.0] * 4))
    return pixels.reshape(-1, 2)


@pytest.mark.parametrize(("model", "distortion"), LENSES)
def test_project_is_opencvs(model: CameraModel, distortion: list[float]) -> None:
    points = points_in_view(1)
    pixels = _core.project(core_camera(model, distortion), points)
    assert np.abs(pixels - opencv_pixels(model, distortion, points)).max() < PIXEL_TOLERANCE


@pytest.mark.parametrize(("model", "distortion"), LENSES)
def test_unproject_is_opencvs(model: CameraModel, distortion: list[float]) -> None:
    rng = np.random.default_rng(2)
    pixels = rng.uniform([200.0, 150.0], [1080.0, 810.0], (300, 2))
    rays = _core.unproject(core_camera(model, distortion), pixels)
    # OpenCV iterates a fixed number of times unless it is told not to.
    criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 200, 1e-14)
    if model == "equidistant":
        ideal = cv2.fisheye.undistortPoints(pixels[:, None], K, np.array(distortion), criteria=criteria)
    else:
        ideal = cv2.undistortPoints(pixels[:, None], K, np.array(distortion or [0.0] * 4), criteria=criteria)
    assert np.abs(rays[:, :2] / rays[:, 2:] - ideal.reshape(-1, 2)).max() < 1e-9
    assert np.allclose(np.linalg.norm(rays, axis=1), 1.0, rtol=0.0, atol=1e-15)


@pytest.mark.parametrize(("model", "distortion"), LENSES)
def test_core_and_numpy_agree_on_what_has_a_pixel(model: CameraModel, distortion: list[float]) -> None:
    rng = np.random.default_rng(3)
    points = rng.normal(size=(5000, 3))
    pixels = _core.project(core_camera(model, distortion), points)
    camera = Camera(name="c", width=WIDTH, height=HEIGHT, model=model, K=K, distortion=np.array(distortion))
    expected = cameras.project(camera, points)
    both = np.isfinite(pixels).all(axis=1) & np.isfinite(expected).all(axis=1)
    # Where tangential terms fold before the radial ones do the core refuses more: the far rim of the lens only.
    assert not (np.isfinite(pixels).all(axis=1) & ~np.isfinite(expected).all(axis=1)).any()
    assert both.sum() > 0.995 * np.isfinite(expected).all(axis=1).sum()
    assert np.allclose(pixels[both], expected[both], rtol=1e-11, atol=PIXEL_TOLERANCE)


@pytest.mark.parametrize(("model", "distortion"), LENSES)
def test_every_pixel_with_a_ray_comes_back(model: CameraModel, distortion: list[float]) -> None:
    rng = np.random.default_rng(4)
    pixels = rng.uniform([-2000.0, -2000.0], [3000.0, 3000.0], (3000, 2))
    camera = core_camera(model, distortion)
    rays = _core.unproject(camera, pixels)
    found = np.isfinite(rays).all(axis=1)
    assert found.sum() > 100
    back = _core.project(camera, 3.0 * rays[found])
    # Rays nearly in the image plane lose digits in x / z.
    assert np.nanmax(np.abs(back - pixels[found])) < 1e-6
    assert np.isfinite(back).all(axis=1).mean() > 0.999
