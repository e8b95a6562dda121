# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The causal bound on a smooth path, against the bound without a path and against one dense information matrix."""

import numpy as np

from reference.bound import bayesian_bound
from reference.cameras import make_projection, projection_jacobian
from reference.motion_bound import causal_translation_bound, jerk_covariance, transition
from reference.views import hat

CAMERA = make_projection("pinhole", np.array([[1910.0, 0, 511.5], [0, 1910.0, 511.5], [0, 0, 1]]), np.zeros(5))
RNG = np.random.default_rng(3)
X = RNG.uniform(-1.0, 1.0, (6, 3)) * np.array([70.0, 9.0, 16.0])
SIGMA_PX = 2.0


def poses(n: int) -> np.ndarray:
    """Along an arc at 1 km, looking at the origin."""
    T = np.tile(np.eye(4), (n, 1, 1))
    for k, azimuth in enumerate(np.linspace(0.0, 0.3, n)):
        forward = -np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        right = np.cross(forward, [0.0, 0.0, 1.0])
        T[k, :3, :3] = np.stack([right, np.cross(forward, right), forward])
        T[k, :3, 3] = [0.0, 0.0, 1000.0]
    return T


def test_a_path_that_may_be_anywhere_tells_nothing() -> None:
    T = poses(4)
    stamps = np.arange(4.0)
    rough = causal_translation_bound(CAMERA, X, np.eye(18), T, stamps, SIGMA_PX**2 * np.eye(2), density=1e4)
    for k in range(4):
        alone = bayesian_bound(CAMERA, X, np.eye(18), T[: k + 1], SIGMA_PX**2 * np.eye(2))
        # One view leaves 120 m; that the first position is known to 500 m takes (120 / 500)^2 off the variance.
        np.testing.assert_allclose(rough[k], alone.translation_variances[-1], rtol=0.06)


def test_view_by_view_is_one_dense_information_matrix() -> None:
    """All motions and attitudes at once; the path is smooth to 3 m/s^2.5, the views a second apart."""
    T, q, n = poses(3), 3.0, 18
    step = 12
    H = np.zeros((n + 3 * step, n + 3 * step))
    H[:n, :n] = np.eye(n)
    H[n : n + 9, n : n + 9] = np.diag(np.repeat(1.0 / np.array([500.0, 200.0, 50.0]) ** 2, 3))
    for k in range(3):
        at = n + k * step
        if k > 0:
            J = np.zeros((9, H.shape[0]))
            J[:, at - step : at - step + 9] = -transition(1.0)
            J[:, at : at + 9] = np.eye(9)
            H += J.T @ np.linalg.inv(jerk_covariance(1.0, q)) @ J
        R, t = T[k, :3, :3], T[k, :3, 3]
        B = projection_jacobian(CAMERA, X @ R.T + t) @ R
        c = -R.T @ t
        for j in range(6):
            J = np.zeros((2, H.shape[0]))
            J[:, 3 * j : 3 * j + 3] = B[j]
            J[:, at : at + 3] = -B[j]  # the camera moves
            J[:, at + 9 : at + 12] = -B[j] @ hat(X[j] - c)  # the target turns about the camera
            H += J.T @ J / SIGMA_PX**2
    covariance = np.linalg.inv(H)
    last = n + 2 * step
    R, c = T[2, :3, :3], -T[2, :3, :3].T @ T[2, :3, 3]
    to_translation = np.zeros((3, H.shape[0]))
    to_translation[:, last : last + 3] = -R
    to_translation[:, last + 9 : last + 12] = R @ hat(c)
    expected = np.trace(to_translation @ covariance @ to_translation.T)
    found = causal_translation_bound(CAMERA, X, np.eye(n), T, np.arange(3.0), SIGMA_PX**2 * np.eye(2), density=q)
    np.testing.assert_allclose(found[-1], expected, rtol=1e-4)
