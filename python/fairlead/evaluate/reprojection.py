# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Reprojection errors and normalised residuals: what can be said without truth, docs/metrics.md eq. (11)-(13)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64
from scipy.stats import chi2

from fairlead import geometry
from fairlead.evaluate.summary import Series, Summary, root_mean_square, summarise
from fairlead.types import Camera, Estimate, PixelCovariances, Points3, View

Residuals = Float64[np.ndarray, "m 2"]
"""One row per observation."""
PerObservation = Float64[np.ndarray, " m"]

OUTLIER_PROBABILITY = 0.999
"""A squared normalised residual beyond this quantile of chi-square with 2 dof is called an outlier."""
POSE_DOF = 6
"""Degrees of freedom that a pose takes from the residuals of its own view."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Reprojection:
    """All observations of the frames that have a pose, against the projected landmarks."""

    errors_px: PerObservation
    """|r| of each observation [px]; inf where the landmark is not in front of the camera."""
    normalised: Residuals
    """S^-1/2 r of each observation [-]: standard normal if S is true and the pose and model fit."""
    frames: Int64[np.ndarray, " m"]
    """Which estimate each observation belongs to (its position in the run)."""
    summary: Summary
    """Of `errors_px`."""
    rms_in_gate_px: float
    """Over the observations that are no outliers [px]."""
    per_frame_px: Series
    """Rms of each frame [px]; NaN where it has no pose or no observation."""
    nis: Series
    """Sum of squared normalised residuals of each frame divided by its degrees of freedom [-]."""
    noise_factor: float
    """How many times too small the told sigma looks, over all observations [-]."""
    robust_noise_factor: float
    """The same from the median, which outliers do not move [-]."""
    outlier_share: float
    """Share of observations beyond the gate of 99.9 % [-]."""
    n_dropped: int
    """Observations that are not finite, of unknown landmarks, or without a usable covariance."""


def reproject(
    views: Sequence[View],
    estimates: Sequence[Estimate],
    camera: Camera,
    landmarks: Sequence[str],
    models: Sequence[Points3],
) -> Reprojection | None:
    """r = pi(T X_j) - z_j over all frames with a pose, docs/metrics.md eq. (11)-(13).

    Views and estimates are matched by (frame, stamp_ns); `models` holds the positions of `landmarks` that each estimate
    belongs to [m]. None where no observation can be judged.
    """
    view_of = {(view.frame, view.stamp_ns): view for view in views}
    place = {name: row for row, name in enumerate(landmarks)}
    points: list[Points3] = []
    observed: list[Residuals] = []
    covariances: list[PixelCovariances] = []
    frames: list[int] = []
    n_dropped = 0
    for index, (estimate, X) in enumerate(zip(estimates, models, strict=True)):
        view = view_of.get((estimate.frame, estimate.stamp_ns))
        if view is None or not estimate.ok:
            continue
        usable = usable_observations(view, place)
        n_dropped += len(view.landmarks) - len(usable)
        points.append(geometry.transform(estimate.T_camera_target, X[[place[view.landmarks[k]] for k in usable]]))
        observed.append(view.pixels[usable])
        covariances.append(view.covariances[usable])
        frames += [index] * len(usable)
    if not frames:
        return None
    r = geometry.project(camera, np.concatenate(points)) - np.concatenate(observed)
    r[np.isnan(r).any(axis=1)] = np.inf
    white = whitened(r, np.concatenate(covariances))
    return _judge(r, white, np.array(frames, dtype=np.int64), len(estimates), n_dropped)


def whitened(r: Residuals, covariances: Float64[np.ndarray, "m 2 2"]) -> Residuals:
    """L^-1 r with S = L L^T, docs/metrics.md eq. (12); inf where r is."""
    L = np.linalg.cholesky(covariances)
    with np.errstate(invalid="ignore"):
        first = r[:, 0] / L[:, 0, 0]
        second = (r[:, 1] - L[:, 1, 0] * first) / L[:, 1, 1]
    white = np.column_stack([first, second])
    white[np.isinf(r).any(axis=1)] = np.inf
    return white


def usable_observations(view: View, place: Mapping[str, int]) -> Int64[np.ndarray, " m"]:
    """Rows whose landmark is in the model, whose pixel is finite and whose covariance is positive definite."""
    S = view.covariances
    with np.errstate(invalid="ignore", over="ignore"):
        determinant = S[:, 0, 0] * S[:, 1, 1] - S[:, 0, 1] * S[:, 1, 0]
        definite: Bool[np.ndarray, " m"] = np.isfinite(S).all(axis=(1, 2)) & (S[:, 0, 0] > 0.0) & (determinant > 0.0)
    known = np.array([name in place for name in view.landmarks], dtype=bool)
    return np.flatnonzero(known & definite & np.isfinite(view.pixels).all(axis=1))


def _judge(r: Residuals, white: Residuals, frames: np.ndarray, n_frames: int, n_dropped: int) -> Reprojection:
    errors = np.linalg.norm(r, axis=1)
    squares = np.sum(white**2, axis=1)
    gate = float(chi2.ppf(OUTLIER_PROBABILITY, 2))
    counts = np.bincount(frames, minlength=n_frames)
    dof = np.maximum(2 * counts - POSE_DOF, 0)
    sums = np.bincount(frames, weights=squares, minlength=n_frames)
    means = np.bincount(frames, weights=errors**2, minlength=n_frames)
    total = int(dof.sum())
    fitted = np.sqrt(2 * counts.sum() / total) if total else np.nan
    return Reprojection(
        errors_px=errors,
        normalised=white,
        frames=frames,
        summary=summarise(errors),
        rms_in_gate_px=root_mean_square(errors[squares <= gate]),
        per_frame_px=np.sqrt(np.divide(means, counts, out=np.full(n_frames, np.nan), where=counts > 0)),
        nis=np.divide(sums, dof, out=np.full(n_frames, np.nan), where=dof > 0),
        noise_factor=float(np.sqrt(sums[dof > 0].sum() / total)) if total else float("nan"),
        robust_noise_factor=float(np.sqrt(np.median(squares) / chi2.ppf(0.5, 2)) * fitted),
        outlier_share=float(np.mean(squares > gate)),
        n_dropped=n_dropped,
    )
