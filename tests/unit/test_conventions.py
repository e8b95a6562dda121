# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The equations of CONVENTIONS.md, in numbers; (3)-(7) of the core in cpp/tests/geometry."""

import numpy as np

from fairlead import _core, geometry

T_A_B = geometry.exp_se3(np.array([1.0, 2.0, 3.0, 0.3, -0.2, 0.5]))
T_B_C = geometry.exp_se3(np.array([-2.0, 0.5, 1.0, -0.4, 0.9, 0.1]))
R, t = T_A_B[:3, :3], T_A_B[:3, 3]
X = np.array([0.7, -1.1, 0.4])
STEP = 1e-6
XI_STEPS = STEP * np.eye(6)


def moved(T: np.ndarray, point: np.ndarray) -> np.ndarray:
    return T[:3, :3] @ point + T[:3, 3]


def pixels(T: np.ndarray, points: np.ndarray) -> np.ndarray:
    camera = _core.Camera("pinhole", 640, 480, np.array([[500.0, 0, 320], [0, 510.0, 240], [0, 0, 1]]), np.zeros(0))
    return _core.project(camera, geometry.transform(T, points))


def test_inner_names_cancel() -> None:
    """CONVENTIONS.md eq. (1) and (2)."""
    assert np.allclose(moved(T_A_B, np.zeros(3)), t)
    assert np.allclose(moved(T_A_B @ T_B_C, X), moved(T_A_B, moved(T_B_C, X)))
    T_B_A = geometry.inverse(T_A_B)
    assert np.allclose(T_B_A[:3, 3], -R.T @ t)
    assert np.allclose(moved(T_B_A, moved(T_A_B, X)), X)


def test_perturbation_of_a_point() -> None:
    """CONVENTIONS.md eq. (6)-(7): central differences, truncation STEP^2."""
    forward = np.array([moved(geometry.perturb(T_A_B, step), X) for step in XI_STEPS])
    backward = np.array([moved(geometry.perturb(T_A_B, -step), X) for step in XI_STEPS])
    assert np.allclose((forward - backward).T / (2.0 * STEP), np.hstack([R, -R @ geometry.hat(X)]), atol=1e-9)


def test_gauge_leaves_pixels_as_they_are() -> None:
    """CONVENTIONS.md eq. (8), rigid motion and scale, to first order."""
    rng = np.random.default_rng(1)
    points = rng.normal(size=(6, 3))
    T = geometry.exp_se3(np.array([0.1, -0.2, 12.0, 0.3, -0.2, 0.5]))
    for direction in np.eye(7):
        g, s = STEP * direction[:6], STEP * direction[6]
        points_moved = points + g[:3] + np.cross(g[3:], points) + s * points
        xi = -g + s * np.concatenate([T[:3, :3].T @ T[:3, 3], np.zeros(3)])
        change = pixels(geometry.perturb(T, xi), points_moved) - pixels(T, points)
        assert np.abs(change).max() < 1e3 * STEP**2 + 1e-12 * 1e3


def sample_covariance(deviations: np.ndarray) -> np.ndarray:
    return deviations.T @ deviations / len(deviations)


def test_covariance_towards_ros() -> None:
    """CONVENTIONS.md eq. (9): position and fixed-axis rotation before R, by sampling."""
    rng = np.random.default_rng(2)
    A = 1e-4 * rng.normal(size=(6, 6))
    xis = rng.normal(size=(20_000, 6)) @ A.T
    poses = [geometry.perturb(T_A_B, xi) for xi in xis]
    turns = [geometry.log_so3(T[:3, :3] @ R.T) for T in poses]  # R' = Exp(turn) R
    deviations = np.hstack([[T[:3, 3] - t for T in poses], turns])
    B = np.kron(np.eye(2), R)
    expected = B @ sample_covariance(xis) @ B.T
    assert np.abs(sample_covariance(deviations) - expected).max() < 1e-3 * np.abs(expected).max()  # second order: 1e-4


def test_covariance_in_another_target_frame() -> None:
    """CONVENTIONS.md eq. (10): xi' = Ad(G) xi."""
    xi = np.array([0.01, -0.02, 0.03, 0.004, 0.005, -0.006])
    G = T_B_C
    there = geometry.difference(T_A_B @ geometry.inverse(G), geometry.perturb(T_A_B, xi) @ geometry.inverse(G))
    Ad = np.block([[G[:3, :3], geometry.hat(G[:3, 3]) @ G[:3, :3]], [np.zeros((3, 3)), G[:3, :3]]])
    assert np.allclose(there, Ad @ xi, atol=1e-14)


def test_quaternion() -> None:
    """CONVENTIONS.md eq. (11)."""
    quat_xyzw = geometry.quat_xyzw_from_matrix(R)
    v, w = quat_xyzw[:3], quat_xyzw[3]
    assert w >= 0.0
    assert np.allclose((w**2 - v @ v) * np.eye(3) + 2.0 * np.outer(v, v) + 2.0 * w * geometry.hat(v), R)


def test_pixel_zero_is_the_centre_of_a_pixel() -> None:
    """A camera with the principal point in the middle of a 2 x 2 image: the axis meets pixel (0.5, 0.5)."""
    camera = _core.Camera("pinhole", 2, 2, np.array([[1.0, 0, 0.5], [0, 1.0, 0.5], [0, 0, 1]]), np.zeros(0))
    assert np.allclose(_core.project(camera, np.array([[0.0, 0.0, 1.0]])), [[0.5, 0.5]])
