# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Laws of the core's cameras and single-view poses, for all inputs."""

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from fairlead import _core, geometry

K = np.array([[900.0, 0.0, 511.5], [0.0, 880.0, 511.5], [0.0, 0.0, 1.0]])
CAMERAS = [
    _core.Camera("pinhole", 1024, 1024, K, np.zeros(0)),
    _core.Camera("plumb_bob", 1024, 1024, K, np.array([-0.2, 0.05, 1e-3, -1e-3, 0.0])),
    _core.Camera("rational_polynomial", 1024, 1024, K, np.array([0.3, -0.1, 1e-3, 2e-4, 0.02, 0.5, -0.1, 0.03])),
    _core.Camera("equidistant", 1024, 1024, K, np.array([-0.01, 0.02, -0.008, 0.001])),
]
ANY_FLOAT = st.floats(allow_nan=True, allow_infinity=True)
cameras = st.sampled_from(CAMERAS)
seeds = st.integers(0, 2**32 - 1)


def random_motion(rng: np.random.Generator, spread_m: float) -> np.ndarray:
    axis = rng.normal(size=3)
    angle = rng.uniform(0.0, 3.0)
    return geometry.exp_se3(np.concatenate([rng.normal(scale=spread_m, size=3), axis / np.linalg.norm(axis) * angle]))


def random_view(rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Landmarks, a pose of them, and their noisy pixels in the pinhole camera."""
    X = rng.uniform(-1.0, 1.0, (n, 3))
    T = random_motion(rng, 0.0)
    T[:3, 3] = rng.uniform([-0.5, -0.5, 5.0], [0.5, 0.5, 20.0])
    pixels = _core.project(CAMERAS[0], geometry.transform(T, X)) + rng.normal(scale=0.5, size=(n, 2))
    return X, T, pixels


def refined(X: np.ndarray, T: np.ndarray, landmarks: np.ndarray, pixels: np.ndarray) -> tuple:
    covariances = np.tile(0.25 * np.eye(2), (len(pixels), 1, 1))
    return _core.pnp_refine(CAMERAS[0], T, X, landmarks.astype(np.int32), pixels, covariances, 9.21, 50)


def standard_deviations(T_a: np.ndarray, T_b: np.ndarray, information: np.ndarray) -> float:
    """How far two poses are apart, in units of their own uncertainty; iterations stop at about 1e-4."""
    xi = geometry.difference(T_a, T_b)
    return float(np.sqrt(xi @ information @ xi))


@given(cameras, arrays(np.float64, (4, 3), elements=ANY_FLOAT))
def test_a_point_has_a_finite_pixel_or_none(camera: _core.Camera, points: np.ndarray) -> None:
    pixels = _core.project(camera, points)
    has_pixel = np.isfinite(pixels).all(axis=1)
    assert (has_pixel | np.isnan(pixels).all(axis=1)).all()
    assert (points[has_pixel, 2] > 0.0).all()


@given(cameras, arrays(np.float64, (4, 2), elements=ANY_FLOAT))
def test_a_pixel_has_a_ray_that_comes_back_or_none(camera: _core.Camera, pixels: np.ndarray) -> None:
    rays = _core.unproject(camera, pixels)
    has_ray = np.isfinite(rays).all(axis=1)
    assert (has_ray | np.isnan(rays).all(axis=1)).all()
    # x / z of rays nearly in the image plane keeps 1e-16 * (x / z)^2 only.
    steep = rays[has_ray, 2] > 1e-3
    back = _core.project(camera, rays[has_ray][steep])
    error = np.linalg.norm(back - pixels[has_ray][steep], axis=1)
    assert (error <= 1e-9 * (1e3 + np.linalg.norm(pixels[has_ray][steep], axis=1))).all()


@given(cameras, seeds, st.floats(1e-3, 1e3))
def test_a_pixel_does_not_depend_on_the_distance(camera: _core.Camera, seed: int, scale: float) -> None:
    rng = np.random.default_rng(seed)
    points = np.column_stack([rng.uniform(-0.5, 0.5, (5, 2)), np.ones(5)])
    assert np.allclose(_core.project(camera, scale * points), _core.project(camera, points), rtol=0.0, atol=1e-9)


@given(seeds, st.integers(6, 30))
def test_landmark_order_is_irrelevant(seed: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    X, T, pixels = random_view(rng, n)
    here = refined(X, T, np.arange(n), pixels)
    order = rng.permutation(n)
    there = refined(X, T, order, pixels[order])
    assume(here[5])
    assert there[5]
    assert here[3] == there[3]
    assert standard_deviations(here[0], there[0], here[1]) < 1e-2


@given(seeds, st.floats(0.0, 1e4))
def test_another_target_frame_gives_the_same_camera(seed: int, spread_m: float) -> None:
    """X' = G X gives T' = T inv(G), and the information moves by the adjoint of G."""
    rng = np.random.default_rng(seed)
    X, T, pixels = random_view(rng, 12)
    G = random_motion(rng, spread_m)
    here = refined(X, T, np.arange(12), pixels)
    there = refined(geometry.transform(G, X), T @ geometry.inverse(G), np.arange(12), pixels)
    assume(here[5])
    assert there[5]
    assert standard_deviations(here[0], there[0] @ G, here[1]) < 1e-2
    # T' Exp(xi') = T Exp(xi) inv(G) with xi' = Ad(G) xi, so H = Ad(G)^T H' Ad(G).
    Ad = geometry.adjoint(G)
    size = np.abs(Ad).max() ** 2 * np.abs(there[1]).max()
    assert np.abs(Ad.T @ there[1] @ Ad - here[1]).max() <= 1e-3 * np.abs(here[1]).max() + 1e-13 * size


@given(seeds, st.integers(0, 12), st.floats(0.0, 3.0), st.sampled_from([0.0, 1e-9, 1e-3, 1.0, 1e6, 1e150]))
def test_rubbish_is_refused_or_answered_in_front(seed: int, n: int, noise: float, size: float) -> None:
    """Any landmarks with any pixels: finite and in front of the camera, or not ok and NaN."""
    rng = np.random.default_rng(seed)
    X = size * rng.normal(size=(n, 3)) * rng.choice([0.0, 1.0, 1e-6], size=3)
    pixels = 500.0 + 200.0 * noise * rng.normal(size=(n, 2))
    pixels[rng.random(n) < 0.1] = np.nan
    covariances = np.tile(np.eye(2), (n, 1, 1))
    pose, _, ok = _core.ransac(CAMERAS[0], X, np.arange(n, dtype=np.int32), pixels, covariances, seed=seed)
    T = pose[0]
    assert ok == bool(np.isfinite(T).all())
    if ok:
        in_front = geometry.transform(T, X)[:, 2] > 0.0
        assert in_front.sum() >= 4
        assert np.allclose(T[:3, :3].T @ T[:3, :3], np.eye(3), rtol=0.0, atol=1e-12)
        assert np.linalg.det(T[:3, :3]) > 0.0
        scale = 1.0 / np.sqrt(np.diag(pose[1]))  # metres and radians of a target of any size
        assert np.linalg.eigvalsh(scale[:, None] * pose[1] * scale).min() > 0.0
