# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The Bayesian bound: the inverse of the information at the truth, docs/bound.md eq. (8)-(13)."""

from dataclasses import dataclass

import numpy as np

from reference.cameras import Project, projection_jacobian
from reference.views import centre_and_rotation, hat, xi_from_step


@dataclass(frozen=True, kw_only=True)
class Bound:
    """The least covariance of landmarks and poses together with what it means in metres and degrees."""

    landmark_covariance: np.ndarray
    """(3n, 3n) [m^2]."""
    pose_covariances: np.ndarray
    """(k, 6, 6) of xi = (rho, phi) in T Exp(xi), target axes [m, rad]."""
    centre_covariances: np.ndarray
    """(k, 3, 3) of the camera's position in the target frame [m^2]."""

    @property
    def landmark_variance(self) -> float:
        """E |X_j - X_j^|^2, mean over landmarks [m^2], docs/bound.md eq. (11)."""
        return 3.0 * float(np.diag(self.landmark_covariance).mean())

    @property
    def rotation_variances(self) -> np.ndarray:
        """E |phi|^2 of each view [rad^2], docs/bound.md eq. (12)."""
        return np.trace(self.pose_covariances[:, 3:, 3:], axis1=1, axis2=2)

    @property
    def translation_variances(self) -> np.ndarray:
        """E |t - t^|^2 of each view [m^2]; dt = R rho, docs/bound.md eq. (12)."""
        return np.trace(self.pose_covariances[:, :3, :3], axis1=1, axis2=2)

    @property
    def centre_variances(self) -> np.ndarray:
        """E |c - c^|^2 of each view [m^2], docs/bound.md eq. (13)."""
        return np.trace(self.centre_covariances, axis1=1, axis2=2)


def bayesian_bound(
    project: Project, X: np.ndarray, P0: np.ndarray, T_camera_target: np.ndarray, covariances: np.ndarray
) -> Bound:
    """Information of all views and of the prior at the true (X, T), poses a priori unknown, docs/bound.md eq. (8)-(10).

    Parameters
    ----------
    project : p_camera -> z [px]
    X : (n, 3) true landmarks [m]
    P0 : (3n, 3n) prior covariance [m^2]; may be singular (landmarks known exactly)
    T_camera_target : (k, 4, 4) true poses
    covariances : (k, n, 2, 2) or anything that broadcasts to it [px^2]; infinite where a landmark is not seen

    Raises LinAlgError if a view alone does not determine its pose when the landmarks are known.
    """
    c, R = centre_and_rotation(T_camera_target)
    k, n = len(R), len(X)
    p = np.einsum("kij,knj->kni", R, X[None] - c[:, None])
    S = np.broadcast_to(covariances, (k, n, 2, 2))
    seen = np.isfinite(S).all(axis=(2, 3)) & (p[..., 2] > 0)
    information = np.where(seen[..., None, None], np.linalg.inv(np.where(seen[..., None, None], S, np.eye(2))), 0.0)
    J = np.where(seen[..., None, None], projection_jacobian(project, p), 0.0)
    by_landmark = J @ R[:, None]
    by_view = np.concatenate([-by_landmark, J @ -hat(p)], axis=-1)  # centre, left rotation vector
    weighted = np.swapaxes(by_view, -1, -2) @ information
    H_pp = (weighted @ by_view).sum(axis=1)
    H_px = (weighted @ by_landmark).transpose(0, 2, 1, 3).reshape(k, 6, 3 * n)
    H_xx = (np.swapaxes(by_landmark, -1, -2) @ information @ by_landmark).sum(axis=0)

    G = np.linalg.solve(H_pp, H_px)
    A = -np.einsum("kai,kaj->ij", H_px, G)
    at = np.arange(3 * n).reshape(n, 3)
    A[at[:, :, None], at[:, None, :]] += H_xx
    Sigma = _combine(P0, 0.5 * (A + A.T))
    step = np.linalg.inv(H_pp) + G @ Sigma @ np.swapaxes(G, -1, -2)
    B = xi_from_step(T_camera_target)
    return Bound(
        landmark_covariance=Sigma,
        pose_covariances=B @ step @ np.swapaxes(B, -1, -2),
        centre_covariances=step[:, :3, :3],
    )


def _combine(P0: np.ndarray, information: np.ndarray) -> np.ndarray:
    """(P0^-1 + A)^-1 = L (I + L^T A L)^-1 L^T with P0 = L L^T, which needs no inverse of P0, docs/bound.md eq. (9)."""
    diagonal = np.diag(P0)
    if np.count_nonzero(P0 - np.diag(diagonal)) == 0:
        L = np.diag(np.sqrt(diagonal))
    else:
        values, vectors = np.linalg.eigh(P0)
        L = vectors * np.sqrt(np.maximum(values, 0.0))
    return L @ np.linalg.solve(np.eye(len(P0)) + L.T @ information @ L, L.T)
