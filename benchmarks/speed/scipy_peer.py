# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The same window solve by `scipy.optimize.least_squares` with exact derivatives, vectorised over all observations."""

import time

import numpy as np
from scipy.optimize import least_squares
from scipy.sparse import csr_array
from scipy.spatial.transform import Rotation

from benchmarks.speed.problem import WindowProblem
from benchmarks.speed.solver import Answer, Settings


def _hat(v: np.ndarray) -> np.ndarray:
    """(..., 3) -> (..., 3, 3)."""
    zero = np.zeros(v.shape[:-1])
    x, y, z = np.moveaxis(v, -1, 0)
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(*v.shape, 3)


def _right_jacobian(phi: np.ndarray) -> np.ndarray:
    """J_r(phi) of Exp(phi + d) = Exp(phi) Exp(J_r d), (k, 3) -> (k, 3, 3)."""
    angle = np.linalg.norm(phi, axis=1)[:, None, None]
    small = angle < 1e-4
    safe = np.where(small, 1.0, angle)
    a = np.where(small, 0.5 - angle**2 / 24.0, (1.0 - np.cos(safe)) / safe**2)
    b = np.where(small, (1.0 - angle**2 / 20.0) / 6.0, (safe - np.sin(safe)) / safe**3)
    W = _hat(phi)
    return np.eye(3) - a * W + b * (W @ W)


class Scipy:
    """Unknowns X (3n), then phi and d of each view: R = R_start Exp(phi), t = t_start + d (same optimum as with xi).

    Variants: `trf-lsmr` (sparse), `lm` (MINPACK, dense). Steps are scaled by the Jacobian (x_scale="jac"). There is no
    initial damping to set.
    """

    def prepare(self, problem: WindowProblem) -> None:
        self._problem = problem
        n, k = problem.landmarks, problem.views
        point = np.tile(3 * np.arange(n)[:, None] + np.arange(3), (k, 1, 1))
        pose = np.repeat(3 * n + 6 * np.arange(k), n).reshape(k, n, 1) + np.arange(6)
        columns = np.repeat(np.concatenate([point, pose], axis=2)[:, :, None], 2, axis=2)
        self._columns = np.concatenate([columns.ravel(), np.arange(3 * n)])
        self._rows = np.concatenate([np.arange(0, columns.size, 9), columns.size + np.arange(3 * n + 1)])

    def _unpack(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        n = self._problem.landmarks
        steps = x[3 * n :].reshape(-1, 6)
        R = self._problem.T_start[:, :3, :3] @ Rotation.from_rotvec(steps[:, :3]).as_matrix()
        return x[: 3 * n].reshape(n, 3), R, self._problem.T_start[:, :3, 3] + steps[:, 3:], steps[:, :3]

    def _residuals(self, x: np.ndarray) -> np.ndarray:
        problem, K = self._problem, self._problem.camera.K
        X, R, t, _ = self._unpack(x)
        p = np.einsum("kij,nj->kni", R, X) + t[:, None]
        z = p[..., :2] / p[..., 2:] * np.diag(K)[:2] + K[:2, 2]
        data = (z - problem.pixels) / problem.sigma_px
        return np.concatenate([data.ravel(), ((X - problem.X0) / problem.prior_sigma_m).ravel()])

    def _jacobian(self, x: np.ndarray) -> csr_array:
        problem, K = self._problem, self._problem.camera.K
        X, R, t, phi = self._unpack(x)
        p = np.einsum("kij,nj->kni", R, X) + t[:, None]
        J = np.zeros((*p.shape[:2], 2, 3))
        f = np.diag(K)[:2] / problem.sigma_px / p[..., 2:]
        J[..., [0, 1], [0, 1]] = f
        J[..., 2] = -f * p[..., :2] / p[..., 2:]
        B = J @ R[:, None]
        turn = -(B @ _hat(X)) @ _right_jacobian(phi)[:, None]
        data = np.concatenate([B, turn, J], axis=-1)
        values = np.concatenate([data.ravel(), np.full(X.size, 1.0 / problem.prior_sigma_m)])
        return csr_array((values, self._columns, self._rows), shape=(len(self._rows) - 1, len(x)))

    def solve(self, settings: Settings, seconds: float) -> tuple[float, int]:
        method, _, linear = settings.variant.partition("-")
        start = np.concatenate([self._problem.X0.ravel(), np.zeros(6 * self._problem.views)])
        options = {} if method == "lm" else {"tr_solver": linear}
        spent, solves = 0.0, 0
        while solves == 0 or spent < seconds:
            begin = time.process_time()
            found = least_squares(
                self._residuals,
                start,
                jac=lambda x: self._jacobian(x).toarray() if method == "lm" else self._jacobian(x),
                method=method,
                x_scale="jac",
                ftol=max(settings.tolerance, 1e-15),
                xtol=1e-15,
                gtol=1e-15,
                max_nfev=settings.max_iterations,
                **options,
            )
            spent += time.process_time() - begin
            solves += 1
        self._x = found.x
        return spent / solves, int(found.njev)

    def answer(self) -> Answer:
        X, R, t, _ = self._unpack(self._x)
        T = np.tile(np.eye(4), (len(R), 1, 1))
        T[:, :3, :3], T[:, :3, 3] = R, t
        return Answer(X=X, T=T)
