# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The Bayesian bound of a sequence with the measured covariance of a network, docs/reproduce.md section 5."""

from dataclasses import dataclass, fields, replace

import numpy as np

from fairlead.pnp import MIN_POINTS
from fairlead.reproduce.methods import Flight, recorded
from fairlead.study.recorded import solve_recorded


@dataclass(frozen=True, kw_only=True, eq=False)
class Bound:
    """Least root mean squares of one flight; NaN in frames of too few landmarks for a pose."""

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
        """Over landmarks."""
        return float(np.sqrt(3.0 * np.diag(self.X_covariance).mean()))


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
    each = [bound(_of(flight, np.arange(k + 1)), factor, inefficiency, design_effect) for k in range(len(flight.views))]
    return Bound(
        pose_covariances=np.array([one.pose_covariances[-1] for one in each]), X_covariance=each[-1].X_covariance
    )


def _solve(flight: Flight, P0: np.ndarray, factor: float) -> tuple[np.ndarray, np.ndarray]:
    """A view of too few landmarks for a pose has no bound, NaN, and says nothing of the model."""
    placed = np.count_nonzero(np.isfinite(flight.observed.pixels).all(axis=2), axis=1) >= MIN_POINTS
    poses = np.full((len(placed), 6, 6), np.nan)
    if not placed.any():
        return poses, P0
    used = _of(flight, np.flatnonzero(placed))
    answer = solve_recorded("bound", recorded(used, P0, factor * used.observed.covariances))
    poses[placed] = answer.pose_covariances
    return poses, answer.X_covariance


def _of(flight: Flight, frames: np.ndarray) -> Flight:
    """The same flight with some of its frames."""
    seen = flight.observed
    cut = {each.name: getattr(seen, each.name)[frames] for each in fields(seen)}
    views = tuple(flight.views[k] for k in frames)
    return replace(flight, views=views, observed=replace(seen, **cut), T_true=flight.T_true[frames])
