# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The term that integrates the landmarks out of the posterior, docs/bound.md eq. (19)-(20)."""

import numpy as np

from reference.cameras import Project, projection_jacobian
from reference.views import centre_and_rotation, move


def _information(
    project: Project, whiteners: np.ndarray, X_seen: np.ndarray, T: np.ndarray, view: np.ndarray
) -> np.ndarray:
    """M_kj = B^T W^T W B of each observation, (m, 3, 3); W already holds the noise and the robust weight."""
    c, R = centre_and_rotation(T)
    p = np.einsum("mij,mj->mi", R[view], X_seen - c[view])
    B = whiteners @ projection_jacobian(project, p) @ R[view]
    return np.swapaxes(B, 1, 2) @ B


def structure_volume(
    project: Project,
    prior_information: np.ndarray,
    whiteners: np.ndarray,
    observation: tuple[np.ndarray, np.ndarray],
    estimate: tuple[np.ndarray, np.ndarray],
) -> tuple[float, np.ndarray]:
    """L = 1/2 log det(P0^-1 + blkdiag_j sum_k M_kj) and dL / d (X, step of each view), docs/bound.md eq. (19)-(20).

    Parameters
    ----------
    prior_information : (3n, 3n) [1/m^2]
    whiteners : (m, 2, 2)
    observation : view and landmark of each observation
    estimate : X (n, 3) and T_camera_target (k, 4, 4)

    The gradient is by central differences with steps of 1e-3 of the range and 1e-3 rad: six digits.
    """
    (view, landmark), (X, T) = observation, estimate
    n, k = len(X), len(T)
    at = np.arange(3 * n).reshape(n, 3)
    H = prior_information.copy()
    np.add.at(
        H,
        (at[landmark][:, :, None], at[landmark][:, None, :]),
        _information(project, whiteners, X[landmark], T, view),
    )
    Q = np.linalg.inv(H)[at[landmark][:, :, None], at[landmark][:, None, :]]
    metres = 1e-3 * float(np.linalg.norm(X[landmark] - centre_and_rotation(T)[0][view], axis=1).mean())
    gradient = np.zeros(3 * n + 6 * k)
    for i in range(9):
        h = metres if i < 6 else 1e-3
        dX, dT = np.zeros(3), np.zeros((k, 6))
        if i < 3:
            dX[i] = h
        else:
            dT[:, i - 3] = h
        plus = _information(project, whiteners, X[landmark] + dX, move(T, dT), view)
        minus = _information(project, whiteners, X[landmark] - dX, move(T, -dT), view)
        slope = 0.5 * np.einsum("mab,mab->m", Q, plus - minus) / (2 * h)
        np.add.at(gradient, 3 * landmark + i if i < 3 else 3 * n + 6 * view + i - 3, slope)
    return float(0.5 * np.linalg.slogdet(H)[1]), gradient
