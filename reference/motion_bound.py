# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Causal Bayesian bound on a smooth path: what all views so far tell of the newest pose, docs/bound.md eq. (19)-(20).

A Kalman filter at the truth over landmarks, and position, velocity and acceleration of the camera in the target frame
(white noise on the jerk); attitudes are free in every view.
"""

import numpy as np
from scipy.linalg import block_diag

from reference.cameras import Project, projection_jacobian
from reference.views import hat

_UNKNOWN = (500.0, 200.0, 50.0)
"""Of a motion that nobody has seen: m, m/s, m/s^2; far more than any view leaves."""


def transition(dt: float) -> np.ndarray:
    """(p, v, a) after dt of constant acceleration, (9, 9)."""
    one = np.array([[1.0, dt, 0.5 * dt * dt], [0.0, 1.0, dt], [0.0, 0.0, 1.0]])
    return np.kron(one, np.eye(3))


def jerk_covariance(dt: float, density: float) -> np.ndarray:
    """What white noise of the jerk adds in dt, (9, 9); density in m/s^2.5."""
    one = [[dt**5 / 20, dt**4 / 8, dt**3 / 6], [dt**4 / 8, dt**3 / 3, dt**2 / 2], [dt**3 / 6, dt**2 / 2, dt]]
    return density**2 * np.kron(np.array(one), np.eye(3))


def causal_translation_bound(
    project: Project,
    X: np.ndarray,
    P0: np.ndarray,
    T: np.ndarray,
    stamps_s: np.ndarray,
    S: np.ndarray,
    density: float,
) -> np.ndarray:
    """Trace of the covariance of t_camera_target after each view [m^2], (views,).

    project: points in the camera to pixels; P0 (3n, 3n) [m^2]; T (views, 4, 4) the truth; S (2, 2) of every
    observation [px^2]. All landmarks are seen in all views.
    """
    n = X.shape[0]
    P = block_diag(P0, *(sigma**2 * np.eye(3) for sigma in _UNKNOWN))
    W = np.kron(np.eye(n), np.linalg.inv(S))
    bound = np.empty(len(T))
    for k, pose in enumerate(T):
        if k > 0:
            dt = float(stamps_s[k] - stamps_s[k - 1])
            F = block_diag(np.eye(3 * n), transition(dt))
            P = F @ P @ F.T
            P[3 * n :, 3 * n :] += jerk_covariance(dt, density)
        J = _jacobian(project, X, pose)
        full = np.zeros((J.shape[1], J.shape[1]))
        full[:-3, :-3] = np.linalg.inv(P)
        full += J.T @ W @ J
        covariance = np.linalg.inv(0.5 * (full + full.T))
        P = covariance[:-3, :-3]
        P = 0.5 * (P + P.T)
        bound[k] = np.trace(_position(pose, n) @ covariance @ _position(pose, n).T)
    return bound


def _rho(pose: np.ndarray, n: int) -> np.ndarray:
    """rho of T Exp(rho, phi) from (X, p, v, a, phi): the camera's position c = -R^T t moves by -rho + c x phi."""
    c = -pose[:3, :3].T @ pose[:3, 3]
    rho = np.zeros((3, 3 * n + 12))
    rho[:, 3 * n : 3 * n + 3] = -np.eye(3)
    rho[:, -3:] = hat(c)
    return rho


def _position(pose: np.ndarray, n: int) -> np.ndarray:
    """Of t_camera_target: R rho."""
    return pose[:3, :3] @ _rho(pose, n)


def _jacobian(project: Project, X: np.ndarray, pose: np.ndarray) -> np.ndarray:
    """Of all pixels by (X, p, v, a, phi), (2n, 3n + 12)."""
    n = X.shape[0]
    R = pose[:3, :3]
    by_point = projection_jacobian(project, X @ R.T + pose[:3, 3]) @ R
    rho = _rho(pose, n)
    J = np.zeros((2 * n, 3 * n + 12))
    for j, B in enumerate(by_point):
        rows = slice(2 * j, 2 * j + 2)
        J[rows] = B @ rho
        J[rows, -3:] -= B @ hat(X[j])
        J[rows, 3 * j : 3 * j + 3] += B
    return J
