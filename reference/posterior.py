# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The posterior of landmarks and poses, minimised by scipy, docs/bound.md eq. (1)-(7)."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag
from scipy.optimize import least_squares

from reference.cameras import Project
from reference.views import centre_and_rotation, move, xi_from_step


def robust_loss(s: np.ndarray, a: float) -> np.ndarray:
    """rho(s) = s up to a, then a (2 - a / s), docs/bound.md eq. (6)."""
    return np.where(s <= a, s, a * (2.0 - a / np.maximum(s, a))) if np.isfinite(a) else s


def robust_weight(s: np.ndarray, a: float) -> np.ndarray:
    """rho'(s) = 1 up to a, then (a / s)^2."""
    return np.where(s <= a, 1.0, (a / np.maximum(s, a)) ** 2) if np.isfinite(a) else np.ones_like(s)


@dataclass(frozen=True, kw_only=True)
class Problem:
    """Everything that E depends on. Observation i is of landmark `landmark[i]` in view `view[i]`."""

    project: Project
    X0: np.ndarray
    """(n, 3) prior mean [m]."""
    P0: np.ndarray | None
    """(3n, 3n) prior covariance [m^2], regular; None is no prior."""
    view: np.ndarray
    landmark: np.ndarray
    pixels: np.ndarray
    """(m, 2) [px]."""
    covariances: np.ndarray
    """(m, 2, 2) [px^2]."""
    loss_threshold: float = np.inf
    noise_factor: float = 1.0
    prior_factor: float = 1.0


@dataclass(frozen=True, kw_only=True)
class Solution:
    """Where E is least, and the inverse of its Gauss-Newton Hessian there."""

    X: np.ndarray
    """(n, 3) [m]."""
    T_camera_target: np.ndarray
    """(k, 4, 4)."""
    cost: float
    """E [-]."""
    covariance: np.ndarray
    """(3n + 6k, 3n + 6k) of (X, xi of each view), xi as in T Exp(xi)."""
    gradient_norm: float
    """Largest |dE/dx_i| / sqrt(d2E/dx_i^2): the distance from the optimum, one coordinate at a time [sigma]."""

    @property
    def landmark_covariance(self) -> np.ndarray:
        """(3n, 3n) [m^2]."""
        return self.covariance[: self.X.size, : self.X.size]

    @property
    def pose_covariances(self) -> np.ndarray:
        """(k, 6, 6) of xi, [m, rad]."""
        start = self.X.size + 6 * np.arange(len(self.T_camera_target))
        return np.stack([self.covariance[s : s + 6, s : s + 6] for s in start])


def _whitener(covariances: np.ndarray) -> np.ndarray:
    """W with W^T W = covariance^-1, one a matrix."""
    return np.linalg.inv(np.linalg.cholesky(covariances))


def _robust(u: np.ndarray, a: float) -> np.ndarray:
    """Shrinks u so that its square is rho(u^T u)."""
    s = np.einsum("mi,mi->m", u, u)
    return u * np.sqrt(robust_loss(s, a) / np.maximum(s, 1e-300))[:, None] if np.isfinite(a) else u


class _Residuals:
    """Whitened residuals as a function of x = (X, step of each view about the pose T)."""

    def __init__(self, problem: Problem, T: np.ndarray) -> None:
        self.problem, self.T = problem, T
        self.n, self.k, self.m = len(problem.X0), len(T), len(problem.view)
        self.W = _whitener(problem.noise_factor * problem.covariances)
        self.A = np.zeros((0, 3 * self.n))
        if problem.P0 is not None:
            self.A = _whitener(problem.prior_factor * problem.P0)
            inverse = np.linalg.inv(problem.P0)
            weights = np.trace(inverse.reshape(self.n, 3, self.n, 3).diagonal(axis1=0, axis2=2), axis1=0, axis2=1)
            self.x0 = (problem.X0 - weights @ problem.X0 / weights.sum()).ravel()
            self.by_scale = inverse @ self.x0 / (self.x0 @ inverse @ self.x0)
        reach = problem.X0[problem.landmark] - centre_and_rotation(T)[0][problem.view]
        self.metres = 1e-5 * float(np.linalg.norm(reach, axis=1).mean())

    def unpack(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return x[: 3 * self.n].reshape(-1, 3), move(self.T, x[3 * self.n :].reshape(-1, 6))

    def images(self, x: np.ndarray, a: float) -> np.ndarray:
        """(m, 2): W (pi(R (X - c)) - z), shrunk by the loss."""
        p, (X, T) = self.problem, self.unpack(x)
        c, R = centre_and_rotation(T)
        points = np.einsum("mij,mj->mi", R[p.view], X[p.landmark] - c[p.view])
        return _robust(np.einsum("mij,mj->mi", self.W, p.project(points) - p.pixels), a)

    def _scale(self, x: np.ndarray) -> tuple[float, np.ndarray]:
        """s and e of X = X0 + (s - 1) x0 + e, docs/estimator.md eq. (2)."""
        u = x[: 3 * self.n] - self.problem.X0.ravel()
        s = 1.0 + self.by_scale @ u
        return s, u - (s - 1.0) * self.x0

    def prior(self, x: np.ndarray) -> np.ndarray:
        """Whitened d = (s - 1) x0 + e / s."""
        if not len(self.A):
            return np.zeros(0)
        s, e = self._scale(x)
        return self.A @ ((s - 1.0) * self.x0 + e / s)

    def prior_jacobian(self, x: np.ndarray) -> np.ndarray:
        """d prior / d X, (3n, 3n)."""
        if not len(self.A):
            return self.A
        s, e = self._scale(x)
        w = self.by_scale
        shape = (np.eye(3 * self.n) - np.outer(self.x0, w)) / s - np.outer(e, w) / s**2
        return self.A @ (np.outer(self.x0, w) + shape)

    def jacobian(self, x: np.ndarray, a: float) -> np.ndarray:
        """d images / d x, (2m, 3n + 6k), by central differences.

        A residual depends on one landmark and one view, so all of a kind are shifted at once: 2 x 9 evaluations.
        """
        rows = np.arange(2 * self.m).reshape(-1, 2)
        J = np.zeros((2 * self.m, len(x)))
        for i in range(9):
            mine = slice(i, 3 * self.n, 3) if i < 3 else slice(3 * self.n + i - 3, None, 6)
            h = np.zeros_like(x)
            h[mine] = self.metres if i < 6 else 1e-5
            columns = 3 * self.problem.landmark + i if i < 3 else 3 * self.n + 6 * self.problem.view + i - 3
            J[rows, columns[:, None]] = (self.images(x + h, a) - self.images(x - h, a)) / (2 * h[mine][0])
        return J


def solve(problem: Problem, X: np.ndarray, T_camera_target: np.ndarray, iterations: int = 200) -> Solution:
    """Minimise E from (X, T) by scipy's trust-region reflective method, docs/bound.md eq. (1).

    Then reweighted Gauss-Newton about what was found, for the digits that a cost of 1e2 cannot show any more.
    The covariance is NaN where there is no prior: seven directions are then free.
    """
    T, a = np.array(T_camera_target, dtype=float), problem.loss_threshold
    system = _Residuals(problem, T)
    pad = np.zeros((len(system.A), 6 * system.k))
    found = least_squares(
        lambda x: np.r_[system.images(x, a).ravel(), system.prior(x)],
        np.r_[X.ravel(), np.zeros(6 * system.k)],
        lambda x: np.vstack([system.jacobian(x, a), np.hstack([system.prior_jacobian(x), pad])]),
        method="trf", x_scale="jac", ftol=1e-10, xtol=1e-10, gtol=1e-10, max_nfev=iterations,
    )  # fmt: skip
    X, T = system.unpack(found.x)
    if problem.P0 is not None:
        X, T = _polish(problem, X, T)
    return _summarise(problem, X, T)


def _normal_equations(problem: Problem, X: np.ndarray, T: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Hessian with the robust weights frozen, gradient and cost, over (X, step of each view about T)."""
    system, a = _Residuals(problem, T), problem.loss_threshold
    x = np.r_[X.ravel(), np.zeros(6 * len(T))]
    u, d = system.images(x, np.inf), system.prior(x)
    s = np.einsum("mi,mi->m", u, u)
    w = robust_weight(s, a)
    J = system.jacobian(x, np.inf)
    H = J.T @ (np.repeat(w, 2)[:, None] * J)
    P = system.prior_jacobian(x)
    H[: X.size, : X.size] += P.T @ P
    gradient = J.T @ (w[:, None] * u).ravel()
    gradient[: X.size] += P.T @ d
    cost = float(0.5 * (robust_loss(s, a).sum() + d @ d))
    return H, gradient, cost


def _polish(problem: Problem, X: np.ndarray, T: np.ndarray, tolerance: float = 1e-5) -> tuple[np.ndarray, np.ndarray]:
    """Reweighted Gauss-Newton to steps below `tolerance` sigma."""
    for _ in range(100):
        H, gradient, _ = _normal_equations(problem, X, T)
        step = -np.linalg.solve(H, gradient)
        X, T = X + step[: X.size].reshape(-1, 3), move(T, step[X.size :].reshape(-1, 6))
        if step @ H @ step < tolerance**2:
            break
    return X, T


def _summarise(problem: Problem, X: np.ndarray, T: np.ndarray) -> Solution:
    """Cost, covariance, docs/bound.md eq. (7), and how well it converged."""
    H, gradient, cost = _normal_equations(problem, X, T)
    B = block_diag(np.eye(X.size), *xi_from_step(T))
    inverse = np.full_like(H, np.nan) if problem.P0 is None else np.linalg.inv(H)
    return Solution(
        X=X,
        T_camera_target=T,
        cost=cost,
        covariance=B @ inverse @ B.T,
        gradient_norm=float(np.max(np.abs(gradient) / np.sqrt(np.diag(H)))),
    )
