# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The Bayesian bound of a sequence with the measured covariance of a network, docs/reproduce.md section 5."""

from dataclasses import dataclass, replace

import numpy as np

from fairlead.reproduce.methods import Flight, recorded
from fairlead.study.recorded import solve_recorded


@dataclass(frozen=True, kw_only=True, eq=False)
class Bound:
    """Least root mean squares of one flight."""

    pose_covariances: np.ndarray
    """(k, 6, 6) of xi."""
    X_covariance: np.ndarray
    """(3n, 3n) [m^2]"""

    @property
    def rotation_rms_deg(self) -> np.ndarray:
        """Of each frame."""
        return np.degrees(np.sqrt(np.trace(self.pose_covariances[:, 3:, 3:], axis1=1, axis2=2)))

    @property
    def translation_rms_m(self) -> np.ndarray:
        """Of each frame."""
        return np.sqrt(np.trace(self.pose_covariances[:, :3, :3], axis1=1, axis2=2))

    @property
    def model_rms_m(self) -> float:
        """Over landmarks; NaN where a view without a pose has no bound."""
        return float(np.sqrt(3.0 * np.diag(self.X_covariance).mean())) if self.X_covariance.size else float("nan")


def bound(flight: Flight, factor: float = 1.0, inefficiency: float = 1.0, design_effect: float = 1.0) -> Bound:
    """All views together; `factor`: of the variances; `inefficiency`: frames that say as much as one.

    Errors that stay for a while weigh on what the views say together, not on what each says alone; those that landmarks
    share, on the pose of each: the covariance with variances times c, where a single view's part counts d times instead
    of c times, docs/reproduce.md eq. (4).
    """
    P0 = flight.told.covariance
    poses, X = _solve(flight, P0, factor * inefficiency)
    if max(inefficiency, design_effect) > 1.0:
        alone, _ = _solve(flight, np.zeros_like(P0), factor)
        poses = poses + (design_effect - inefficiency) * alone
    return Bound(pose_covariances=poses, X_covariance=X)


def causal_bound(flight: Flight, factor: float = 1.0, inefficiency: float = 1.0, design_effect: float = 1.0) -> Bound:
    """Of each frame with the views up to it: what an online estimator can know."""
    each = [bound(_first(flight, k), factor, inefficiency, design_effect) for k in range(1, len(flight.views) + 1)]
    return Bound(
        pose_covariances=np.array([one.pose_covariances[-1] for one in each]), X_covariance=each[-1].X_covariance
    )


def _solve(flight: Flight, P0: np.ndarray, factor: float) -> tuple[np.ndarray, np.ndarray]:
    answer = solve_recorded("bound", recorded(flight, P0, factor * flight.observed.covariances))
    return answer.pose_covariances, answer.X_covariance


def _first(flight: Flight, k: int) -> Flight:
    seen = flight.observed
    cut = replace(
        seen,
        stamps_ns=seen.stamps_ns[:k],
        pixels=seen.pixels[:k],
        covariances=seen.covariances[:k],
        errors=seen.errors[:k],
        visible=seen.visible[:k],
    )
    return replace(flight, views=flight.views[:k], observed=cut, T_true=flight.T_true[:k])
