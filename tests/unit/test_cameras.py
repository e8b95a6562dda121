# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Cameras against hand-computed pixels; OpenCV is asked in tests/oracle."""

from typing import get_args

import numpy as np
import pytest

from fairlead.cameras import distortion_limit, project, unproject
from fairlead.types import Camera, CameraModel

COEFFICIENTS: dict[str, list[float]] = {
    "pinhole": [],
    "plumb_bob": [-0.2, 0.05, 0.001, -0.002, 0.01],
    "rational_polynomial": [0.3, 0.1, 0.001, -0.002, 0.01, 0.5, 0.1, 0.02],
    "equidistant": [0.05, -0.01, 0.003, -0.001],
}


def make_camera(model: CameraModel, distortion: list[float] | None = None) -> Camera:
    K = np.array([[800.0, 0.0, 320.0], [0.0, 810.0, 240.0], [0.0, 0.0, 1.0]])
    coefficients = COEFFICIENTS[model] if distortion is None else distortion
    return Camera(name="c", width=640, height=480, model=model, K=K, distortion=np.array(coefficients))


def test_pinhole_by_hand() -> None:
    points = np.array([[0.1, -0.2, 2.0], [0.0, 0.0, 1.0]])
    assert np.allclose(project(make_camera("pinhole"), points), [[360.0, 159.0], [320.0, 240.0]])


def test_plumb_bob_by_hand() -> None:
    # x = 0.3, y = 0.4: r^2 = 0.25; f = 1 + 0.2 r^2 = 1.05; 2 p1 x y = 0.0024, p1 (r^2 + 2 y^2) = 0.0057
    camera = make_camera("plumb_bob", [0.2, 0.0, 0.01, 0.0, 0.0])
    expected = [800.0 * (0.3 * 1.05 + 0.0024) + 320.0, 810.0 * (0.4 * 1.05 + 0.0057) + 240.0]
    assert np.allclose(project(camera, np.array([[0.3, 0.4, 1.0]])), [expected])


def test_equidistant_by_hand() -> None:
    camera = make_camera("equidistant", [0.1, 0.0, 0.0, 0.0])
    angle = 0.5
    point = np.array([[np.sin(angle), 0.0, np.cos(angle)]])
    assert np.allclose(project(camera, point), [[800.0 * angle * (1.0 + 0.1 * 0.25) + 320.0, 240.0]])


@pytest.mark.parametrize("model", get_args(CameraModel))
def test_what_is_not_in_front_is_nan(model: CameraModel) -> None:
    points = np.array([[0.1, 0.1, -1.0], [0.0, 0.0, 0.0], [np.nan, 0.0, 1.0], [np.inf, 0.0, 1.0], [0.1, 0.1, 1.0]])
    pixels = project(make_camera(model), points)
    assert np.isnan(pixels[:4]).all()
    assert np.isfinite(pixels[4]).all()
    assert project(make_camera(model), np.zeros((0, 3))).shape == (0, 2)


@pytest.mark.parametrize("model", get_args(CameraModel))
def test_unproject_inverts_project(model: CameraModel) -> None:
    rng = np.random.default_rng(3)
    points = np.column_stack([rng.uniform(-0.5, 0.5, (100, 2)), np.ones(100)])
    rays = unproject(make_camera(model), project(make_camera(model), points))
    assert np.allclose(rays, points / np.linalg.norm(points, axis=1, keepdims=True), atol=1e-12)


@pytest.mark.parametrize("model", get_args(CameraModel))
def test_unproject_of_nan_and_far_outside_never_raises(model: CameraModel) -> None:
    rays = unproject(make_camera(model), np.array([[np.nan, 0.0], [1e12, -1e12], [320.0, 240.0]]))
    assert np.isnan(rays[0]).all()
    assert np.allclose(rays[2], [0.0, 0.0, 1.0])
    assert unproject(make_camera(model), np.zeros((0, 2))).shape == (0, 3)


def test_points_where_the_distortion_folds_back_are_nan() -> None:
    # r (1 - 0.2 r^2) grows up to r = sqrt(1 / 0.6)
    camera = make_camera("plumb_bob", [-0.2, 0.0, 0.0, 0.0, 0.0])
    limit = np.sqrt(1.0 / 0.6)
    assert np.isclose(distortion_limit(camera), limit)
    pixels = project(camera, np.array([[0.999 * limit, 0.0, 1.0], [1.001 * limit, 0.0, 1.0]]))
    assert np.isfinite(pixels[0]).all()
    assert np.isnan(pixels[1]).all()
    assert distortion_limit(make_camera("pinhole")) == np.inf


def test_a_pixel_that_no_ray_reaches_is_nan() -> None:
    # r (1 - 0.2 r^2) is 0.861 at most
    camera = make_camera("plumb_bob", [-0.2, 0.0, 0.0, 0.0, 0.0])
    rays = unproject(camera, np.array([[320.0 + 800.0 * 0.86, 240.0], [320.0 + 800.0 * 0.87, 240.0]]))
    assert np.isfinite(rays[0]).all()
    assert np.isnan(rays[1]).all()
