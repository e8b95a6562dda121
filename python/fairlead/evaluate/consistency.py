# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Is the covariance true? NEES and its chi-square bands, docs/metrics.md eq. (18)-(21)."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Float64
from scipy.stats import chi2

from fairlead import geometry
from fairlead.evaluate.summary import Series
from fairlead.types import Matrix4, Matrix6, Target, Vector6

RANK_TOLERANCE = 1e-10
"""Eigenvalues of the correlations below this share of the largest count as zero [-]."""
OUTSIDE_TOLERANCE = 1e-6
"""Share of an error that may lie where the covariance is zero and still be rounding [-]."""

Vector = Float64[np.ndarray, " d"]
SquareMatrix = Float64[np.ndarray, "d d"]


@dataclass(frozen=True, kw_only=True)
class NormalisedSquare:
    """e^T P^+ e with the number of directions that it sums over."""

    value: float
    dof: int
    """Rank of P."""
    outside: bool
    """Whether e has a part where P is zero: an error that the covariance calls impossible, not judged by the value."""


def normalised_square(error: Vector, covariance: SquareMatrix) -> NormalisedSquare:
    """e^T P^+ e, docs/metrics.md eq. (18).

    P is scaled to correlations first, so that metres and radians may be mixed; for an error in the range of P any
    generalised inverse gives the same number, and its dof is the rank.
    """
    sigma = np.sqrt(np.diag(covariance))
    known = sigma > 0.0
    if not known.any():
        return NormalisedSquare(value=0.0, dof=0, outside=bool(np.abs(error).max(initial=0.0) > 0.0))
    correlations = covariance[np.ix_(known, known)] / np.outer(sigma[known], sigma[known])
    scaled = error[known] / sigma[known]
    eigenvalues, V = np.linalg.eigh(correlations)
    kept = eigenvalues > RANK_TOLERANCE * eigenvalues[-1]
    components = V.T @ scaled
    lost = float(np.linalg.norm(components[~kept])) > OUTSIDE_TOLERANCE * float(np.linalg.norm(scaled))
    fixed = float(np.abs(error[~known]).max(initial=0.0)) > OUTSIDE_TOLERANCE * float(np.abs(error).max(initial=0.0))
    value = float(np.sum(components[kept] ** 2 / eigenvalues[kept]))
    return NormalisedSquare(value=value, dof=int(kept.sum()), outside=lost or fixed)


@dataclass(frozen=True, kw_only=True)
class Band:
    """Two-sided chi-square band of NEES / dof [-]."""

    probability: float
    lower: float
    upper: float

    def holds(self, value: float) -> bool:
        """Whether the value lies inside."""
        return self.lower <= value <= self.upper


@lru_cache(maxsize=256)  # a run asks for the same band at every frame
def chi_square_band(dof: int, probability: float) -> Band:
    """Where chi^2_dof / dof lies with this probability, equal tails, docs/metrics.md eq. (20). NaN at 0 dof."""
    if dof == 0:
        return Band(probability=probability, lower=float("nan"), upper=float("nan"))
    tail = 0.5 * (1.0 - probability)
    lower, upper = (chi2.ppf([tail, 1.0 - tail], dof) / dof).tolist()
    return Band(probability=probability, lower=lower, upper=upper)


@dataclass(frozen=True, kw_only=True, eq=False)
class Nees:
    """Normalised estimation error squared of k samples, divided by the degrees of freedom: 1 is right."""

    values: Series
    """NEES / dof of each sample; NaN where there is none."""
    per_dof: float
    """Sum of NEES / sum of dof: above 1 the covariance is too small, below 1 too large."""
    n_samples: int
    dof: int
    """Sum over the samples."""
    band95: Band
    """If the samples were independent."""
    band999: Band
    """If the samples were independent."""
    band999_one: Band
    """If all samples shared one error, as frames of one run share the model's."""
    share_inside_95: float
    """Share of the samples that lie in their own 95 % band [-]."""
    n_outside: int
    """Samples whose error has a part that their covariance calls impossible."""


def nees(samples: Sequence[NormalisedSquare | None]) -> Nees | None:
    """Pool samples, docs/metrics.md eq. (20); None stands for a frame without a pose. None where there is nothing."""
    present = [sample for sample in samples if sample is not None and sample.dof > 0]
    if not present:
        return None
    dof = sum(sample.dof for sample in present)
    inside = [chi_square_band(sample.dof, 0.95).holds(sample.value / sample.dof) for sample in present]
    values = [sample.value / sample.dof if sample is not None and sample.dof else np.nan for sample in samples]
    return Nees(
        values=np.array(values, dtype=np.float64),
        per_dof=sum(sample.value for sample in present) / dof,
        n_samples=len(present),
        dof=dof,
        band95=chi_square_band(dof, 0.95),
        band999=chi_square_band(dof, 0.999),
        band999_one=chi_square_band(round(dof / len(present)), 0.999),
        share_inside_95=float(np.mean(inside)),
        n_outside=sum(sample is not None and sample.outside for sample in samples),
    )


def pose_difference(T_estimated: Matrix4, T_true: Matrix4) -> Vector6:
    """e = (R_est^T (t_true - t_est), Log(R_est^T R_true)), the error that the covariance speaks of [m, rad].

    To first order the xi of T_true = T_est Exp(xi), without the exact logarithm's product of rotation and range error,
    which would be taken for an error across the line of sight, docs/bound.md eq. (15).
    """
    R = T_estimated[:3, :3]
    rotation = np.eye(4)
    rotation[:3, :3] = R.T @ T_true[:3, :3]
    return np.concatenate([R.T @ (T_true[:3, 3] - T_estimated[:3, 3]), geometry.log_se3(rotation)[3:]])


def pose_normalised_square(T_estimated: Matrix4, T_true: Matrix4, covariance: Matrix6) -> NormalisedSquare:
    """e^T P^+ e of one pose, docs/metrics.md eq. (18)."""
    return normalised_square(pose_difference(T_estimated, T_true), covariance)


def model_normalised_square(estimated: Target, true: Target) -> NormalisedSquare | None:
    """(X_est - X_true)^T P^+ (X_est - X_true) over all common landmarks, docs/metrics.md eq. (19).

    The true model's own covariance is not added: it is taken as exact. None where no landmark is common.
    """
    place = {name: index for index, name in enumerate(true.landmarks)}
    rows = np.array([index for index, name in enumerate(estimated.landmarks) if name in place], dtype=np.int64)
    if not rows.size:
        return None
    X_true = true.positions[[place[estimated.landmarks[row]] for row in rows]]
    block = (3 * rows[:, None] + np.arange(3)).ravel()
    return normalised_square((estimated.positions[rows] - X_true).ravel(), estimated.covariance[np.ix_(block, block)])
