# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Pose errors of a run against truth, raw and with the gauge taken out, docs/metrics.md eq. (2)-(9), (18)."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from fairlead.evaluate.alignment import align_poses
from fairlead.evaluate.consistency import Nees, NormalisedSquare, nees, normalised_square, pose_difference
from fairlead.evaluate.failures import (
    FAILURE_POSITION_PERCENT,
    FAILURE_ROTATION_DEG,
    FAILURE_TRANSLATION_PERCENT,
    Failures,
    Flags,
    failed_frames,
    penalised_mean,
)
from fairlead.evaluate.pose import position_error_m, range_m, rotation_error_deg, translation_error_m
from fairlead.evaluate.summary import Series, Summary, summarise
from fairlead.geometry import Similarity
from fairlead.types import Poses

Differences = Float64[np.ndarray, "k 6"]
Covariances6 = Float64[np.ndarray, "k 6 6"]


@dataclass(frozen=True, kw_only=True, eq=False)
class ErrorSeries:
    """One kind of error over the judged frames."""

    values: Series
    """NaN where there is no pose."""
    summary: Summary
    """Over the frames that have a pose: to be read together with the coverage."""
    penalised: float
    """Mean over all judged frames, a failed one counting with its limit."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PoseErrors:
    """Errors of the judged frames under one alignment."""

    rotation_deg: ErrorSeries
    translation_m: ErrorSeries
    translation_percent: ErrorSeries
    position_m: ErrorSeries
    position_percent: ErrorSeries
    failed: Flags
    failures: Failures


@dataclass(frozen=True, kw_only=True, eq=False)
class PoseConsistency:
    """The error xi of each judged frame, in T_true = T_est Exp(xi), with what the covariance says of it."""

    xi: Differences
    """rho [m], phi [rad], target axes; NaN rows where there is no pose."""
    sigma: Differences
    """Roots of the diagonal of the covariance, order of xi."""
    nees: Nees | None


def pose_errors(T_estimated: Poses, T_true: Poses, similarity: Similarity | None = None) -> PoseErrors:
    """Errors of matched poses, docs/metrics.md eq. (2)-(7).

    Parameters
    ----------
    T_estimated, T_true
        (k, 4, 4) T_camera_target of the same frames; NaN where there is no estimate.
    similarity
        Takes the estimated model onto the true one; the poses are moved with it, docs/metrics.md eq. (9).
    """
    T = T_estimated if similarity is None else align_poses(T_estimated, similarity)
    distance = range_m(T_true)
    rotation, translation, position = (
        rotation_error_deg(T, T_true),
        translation_error_m(T, T_true),
        position_error_m(T, T_true),
    )
    percent = 100.0 * translation / distance
    failed = failed_frames(rotation, percent)
    per_cent = np.ones(len(distance))
    metres = 0.01 * distance
    return PoseErrors(
        rotation_deg=_series(rotation, failed, FAILURE_ROTATION_DEG * per_cent),
        translation_m=_series(translation, failed, FAILURE_TRANSLATION_PERCENT * metres),
        translation_percent=_series(percent, failed, FAILURE_TRANSLATION_PERCENT * per_cent),
        position_m=_series(position, failed, FAILURE_POSITION_PERCENT * metres),
        position_percent=_series(100.0 * position / distance, failed, FAILURE_POSITION_PERCENT * per_cent),
        failed=failed,
        failures=Failures(
            n_frames=len(failed),
            n_without_pose=int(np.isnan(rotation).sum()),
            n_wrong=int((failed & ~np.isnan(rotation)).sum()),
        ),
    )


def _series(values: Series, failed: Flags, limits: Series) -> ErrorSeries:
    return ErrorSeries(values=values, summary=summarise(values), penalised=penalised_mean(values, failed, limits))


def pose_consistency(T_estimated: Poses, T_true: Poses, covariances: Covariances6) -> PoseConsistency:
    """xi, its 3-sigma and NEES of matched poses, docs/metrics.md eq. (18), (20)."""
    xi = np.full((len(T_true), 6), np.nan)
    samples: list[NormalisedSquare | None] = []
    for k, (T, T_k, P) in enumerate(zip(T_estimated, T_true, covariances, strict=True)):
        if not np.isfinite(T).all():
            samples.append(None)
            continue
        xi[k] = pose_difference(T, T_k)
        samples.append(normalised_square(xi[k], P))
    return PoseConsistency(
        xi=xi, sigma=np.sqrt(np.diagonal(covariances, axis1=1, axis2=2).astype(np.float64)), nees=nees(samples)
    )
