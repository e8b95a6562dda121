# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Errors of the landmark model, and what became of it where nobody knows the truth, docs/metrics.md eq. (10), (21)."""

from dataclasses import dataclass

import numpy as np

from fairlead import geometry
from fairlead.evaluate.alignment import Alignment, common_landmarks, model_alignment
from fairlead.evaluate.consistency import (
    Nees,
    NormalisedSquare,
    model_normalised_square,
    nees,
    normalised_square,
)
from fairlead.evaluate.summary import Series, Summary, root_mean_square, summarise
from fairlead.types import Points3, Target


@dataclass(frozen=True, kw_only=True, eq=False)
class LandmarkErrors:
    """Distances of the landmarks from the true ones, after one alignment, with the gauge that it took out."""

    names: tuple[str, ...]
    errors_m: Series
    """Per landmark [m]."""
    summary: Summary
    scale: float
    """Of the similarity that was taken out: true size / estimated size [-]."""
    rotation_deg: float
    shift_m: float
    """How far the centroid was moved [m]."""
    similarity: geometry.Similarity


@dataclass(frozen=True, kw_only=True, eq=False)
class ModelErrors:
    """One model against the true one; None where the landmarks do not determine the alignment."""

    raw: LandmarkErrors
    se3: LandmarkErrors | None
    sim3: LandmarkErrors | None
    nees: Nees | None
    """Of all coordinates jointly: one sample."""

    def aligned(self, alignment: Alignment) -> LandmarkErrors | None:
        """The one of this name."""
        return {"raw": self.raw, "se3": self.se3, "sim3": self.sim3}[alignment]


@dataclass(frozen=True, kw_only=True, eq=False)
class ModelChange:
    """From the model that was given to the one that came out; needs no truth."""

    names: tuple[str, ...]
    shifts_m: Series
    """Per landmark [m]."""
    summary: Summary
    sigma_before_m: float
    """Root of the mean variance of the coordinates, as told [m]."""
    sigma_after_m: float
    """The same of the model that came out [m]."""
    prior_factor: float | None
    """How many times too small the told prior looks, docs/metrics.md eq. (21) [-]; None where it cannot be told."""


def landmark_errors(estimated: Target, true: Target, alignment: Alignment) -> LandmarkErrors | None:
    """|S(X_est) - X_true| per landmark by name, docs/metrics.md eq. (10); None where S is not determined."""
    names, X, X_true = common_landmarks(estimated, true)
    similarity = model_alignment(X, X_true, alignment) if names else None
    if similarity is None:
        return None
    moved = similarity.apply(X)
    errors = np.linalg.norm(moved - X_true, axis=1)
    return LandmarkErrors(
        names=names,
        errors_m=errors,
        summary=summarise(errors),
        scale=similarity.scale,
        rotation_deg=float(np.degrees(np.linalg.norm(geometry.log_so3(similarity.R_a_b)))),
        shift_m=float(np.linalg.norm(moved.mean(axis=0) - X.mean(axis=0))),
        similarity=similarity,
    )


def model_errors(estimated: Target, true: Target) -> ModelErrors | None:
    """All alignments and the NEES; None where no landmark is common."""
    raw = landmark_errors(estimated, true, "raw")
    if raw is None:
        return None
    return ModelErrors(
        raw=raw,
        se3=landmark_errors(estimated, true, "se3"),
        sim3=landmark_errors(estimated, true, "sim3"),
        nees=nees([model_normalised_square(estimated, true)]),
    )


def model_change(before: Target, after: Target) -> ModelChange | None:
    """How far the landmarks went, against how far the prior let them, docs/metrics.md eq. (21).

    None where no landmark is common.
    """
    names, X_after, X_before = common_landmarks(after, before)
    if not names:
        return None
    shifts = np.linalg.norm(X_after - X_before, axis=1)
    return ModelChange(
        names=names,
        shifts_m=shifts,
        summary=summarise(shifts),
        sigma_before_m=root_mean_square(coordinate_sigmas(before).ravel()),
        sigma_after_m=root_mean_square(coordinate_sigmas(after).ravel()),
        prior_factor=_prior_factor(before, after) if before.landmarks == after.landmarks else None,
    )


def coordinate_sigmas(target: Target) -> Points3:
    """Root of the variance of each coordinate of each landmark [m]."""
    return np.sqrt(np.clip(np.diag(target.covariance), 0.0, None)).reshape(-1, 3)


def _prior_factor(before: Target, after: Target) -> float | None:
    """sqrt(d^T P0^+ d / tr(P0^+ (P0 - P))), d = X_after - X_before; None where the data told nothing or P0 is zero."""
    square: NormalisedSquare = normalised_square((after.positions - before.positions).ravel(), before.covariance)
    sigma = np.sqrt(np.diag(before.covariance))
    known = sigma > 0.0
    if not known.any():
        return None
    scale = np.outer(sigma[known], sigma[known])
    P0 = before.covariance[np.ix_(known, known)] / scale
    P = after.covariance[np.ix_(known, known)] / scale
    learnt = float(np.trace(np.linalg.pinv(P0, rcond=1e-10, hermitian=True) @ (P0 - P)))
    return float(np.sqrt(square.value / learnt)) if learnt > 0.5 else None
