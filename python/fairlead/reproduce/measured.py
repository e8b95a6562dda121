# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""How wrong a network is on a sequence, and how true its covariance: docs/reproduce.md section 4."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import chi2

from fairlead.design_effect import design_effect, pose_jacobian
from fairlead.reproduce.sequences import Sequence
from fairlead.types import View

PAIRED_NS = 1_000_000
_MEDIAN = float(chi2.ppf(0.5, 2))
_OUTLIER = float(chi2.ppf(0.999, 2))


@dataclass(frozen=True, kw_only=True, eq=False)
class Observed:
    """Observations as arrays over the k frames with truth and the n landmarks; NaN where there is none."""

    stamps_ns: np.ndarray
    pixels: np.ndarray
    """(k, n, 2)"""
    covariances: np.ndarray
    """(k, n, 2, 2)"""
    errors: np.ndarray
    """(k, n, 2): observed minus true [px]."""
    visible: np.ndarray
    """(k, n) bool: really seen."""


@dataclass(frozen=True, kw_only=True)
class Measured:
    """In numbers."""

    mean_px: float
    """Of |error| over what is really visible."""
    rms_px: float
    median_px: float
    p95_px: float
    hidden_px: float
    """Mean over what is hidden but was reported; NaN where nothing was."""
    found: float
    """Share of the visible landmarks that were reported."""
    outliers: float
    """Share of the reported ones beyond the 99.9 % ellipse, of the told covariance or of one that fits the median."""
    factor: float
    """What the told variances must be multiplied by, docs/reproduce.md eq. (1)."""
    nees: float
    """Mean of e^T S^-1 e / 2 over all that was reported, outliers inside: 1 is a true covariance."""
    inside_50: float
    inside_90: float
    inside_99: float
    """Share inside the ellipses of the told covariance."""
    bias_px: float
    """Root mean square over landmarks of the mean error vector over the sequence."""
    inefficiency: float
    """How many frames say as much as one, docs/reproduce.md eq. (2)."""
    stays_s: float
    """For how long errors stay, docs/reproduce.md eq. (3) [s]."""


def observe(sequence: Sequence, views: Iterable[View]) -> Observed:
    """Put views and truth side by side; frames without truth are left out, frames without a view stay empty."""
    k, n = len(sequence.truth), len(sequence.true.landmarks)
    column = {name: j for j, name in enumerate(sequence.true.landmarks)}
    pixels, covariances = np.full((k, n, 2), np.nan), np.full((k, n, 2, 2), np.nan)
    for i, view in enumerate(in_order(sequence, views)):
        if not view.landmarks:
            continue
        at = [column[name] for name in view.landmarks]
        pixels[i, at], covariances[i, at] = view.pixels, view.covariances
    true = np.array([sequence.seen[frame].pixels for frame in sequence.frames])
    return Observed(
        stamps_ns=np.array([pose.stamp_ns for pose in sequence.truth], dtype=np.int64),
        pixels=pixels,
        covariances=covariances,
        errors=pixels - true,
        visible=np.array([sequence.seen[frame].visible for frame in sequence.frames]),
    )


def in_order(sequence: Sequence, views: Iterable[View]) -> list[View]:
    """One view per frame with truth, paired by their stamps to a millisecond; an empty one where there is none.

    Numbers of frames are not compared: a clip numbers its own.
    """
    views = sorted(views, key=lambda view: view.stamp_ns)
    stamps = np.array([view.stamp_ns for view in views], dtype=np.int64)
    found: list[View] = []
    for pose in sequence.truth:
        near = int(np.searchsorted(stamps, pose.stamp_ns - PAIRED_NS))
        if near < len(views) and abs(views[near].stamp_ns - pose.stamp_ns) <= PAIRED_NS:
            found.append(replace(views[near], frame=pose.frame, stamp_ns=pose.stamp_ns))
        else:
            pixels, covariances = np.empty((0, 2)), np.empty((0, 2, 2))
            found.append(
                View(frame=pose.frame, stamp_ns=pose.stamp_ns, landmarks=(), pixels=pixels, covariances=covariances)
            )
    return found


def views_of(landmarks: tuple[str, ...], observed: Observed) -> tuple[View, ...]:
    """The views that say what was observed."""
    views: list[View] = []
    for k, stamp_ns in enumerate(observed.stamps_ns.tolist()):
        seen = np.flatnonzero(np.isfinite(observed.pixels[k]).all(axis=1)).tolist()
        views.append(
            View(
                frame=k,
                stamp_ns=stamp_ns,
                landmarks=tuple(landmarks[j] for j in seen),
                pixels=observed.pixels[k, seen],
                covariances=observed.covariances[k, seen],
            )
        )
    return tuple(views)


def measure(observed: Observed) -> Measured | None:
    """None where nothing was observed."""
    length = np.linalg.norm(observed.errors, axis=2)
    reported = np.isfinite(length)
    if not reported.any():
        return None
    seen, hidden = length[reported & observed.visible], length[reported & ~observed.visible]
    squares, limit = _squares(observed)[reported], _limit(observed)
    factor = 0.5 * float(squares[squares <= limit].mean())
    inefficiency = _inefficiency(observed, factor)
    inside = [float((squares <= chi2.ppf(share, 2)).mean()) for share in (0.5, 0.9, 0.99)]
    return Measured(
        mean_px=float(seen.mean()) if seen.size else np.nan,
        rms_px=float(np.sqrt((seen**2).mean())) if seen.size else np.nan,
        median_px=float(np.median(seen)) if seen.size else np.nan,
        p95_px=float(np.quantile(seen, 0.95)) if seen.size else np.nan,
        hidden_px=float(hidden.mean()) if hidden.size else np.nan,
        found=float(reported[observed.visible].mean()) if observed.visible.any() else np.nan,
        outliers=float((squares > limit).mean()),
        factor=factor,
        nees=0.5 * float(squares.mean()),
        inside_50=inside[0],
        inside_90=inside[1],
        inside_99=inside[2],
        bias_px=_bias(observed),
        inefficiency=inefficiency,
        stays_s=correlation_time_s(observed, inefficiency),
    )


def shared_error(sequence: Sequence, observed: Observed) -> float:
    """The design effect of the visible landmarks, at the true poses, networks.md eq. (8); 1 where nothing is known."""
    views = (
        (observed.errors[k, seen], observed.covariances[k, seen], pose_jacobian(sequence.camera, T, X[seen]))
        for X in [sequence.true.positions]
        for k, T in enumerate(sequence.T_true)
        if (seen := np.isfinite(observed.errors[k]).all(axis=1) & observed.visible[k]).any()
    )
    return float(np.nan_to_num(design_effect(views), nan=1.0))


def outlying(observed: Observed) -> np.ndarray:
    """(k, n) bool: beyond the 99.9 % ellipse, of the told covariance or of one that fits the median."""
    with np.errstate(invalid="ignore"):
        return _squares(observed) > _limit(observed)


def _limit(observed: Observed) -> float:
    squares = _squares(observed)
    return _OUTLIER * max(float(np.median(squares[np.isfinite(squares)])) / _MEDIAN, 1.0)


def correlation_time_s(observed: Observed, inefficiency: float) -> float:
    """The time that makes a frame count for 1/c of an independent one, docs/reproduce.md eq. (3) [s]."""
    interval_s = 1e-9 * float(np.median(np.diff(observed.stamps_ns))) if len(observed.stamps_ns) > 1 else 0.0
    if inefficiency <= 1.0 or interval_s <= 0.0:
        return 0.0
    return interval_s / float(np.log((inefficiency + 1.0) / (inefficiency - 1.0)))


def _squares(observed: Observed) -> np.ndarray:
    """e^T S^-1 e, (k, n); NaN where there is nothing or S is no covariance."""
    S, e = observed.covariances, observed.errors
    with np.errstate(invalid="ignore", divide="ignore"):
        det = S[..., 0, 0] * S[..., 1, 1] - S[..., 0, 1] ** 2
        value = (
            S[..., 1, 1] * e[..., 0] ** 2 - 2.0 * S[..., 0, 1] * e[..., 0] * e[..., 1] + S[..., 0, 0] * e[..., 1] ** 2
        )
        return np.where(det > 0.0, value / det, np.nan)


def _bias(observed: Observed) -> float:
    """Errors of landmarks that were reported in at least ten frames, visible ones."""
    use = np.isfinite(observed.errors).all(axis=2) & observed.visible
    means = [
        observed.errors[use[:, j], j].mean(axis=0) for j in range(use.shape[1]) if np.count_nonzero(use[:, j]) >= 10
    ]
    return float(np.sqrt((np.array(means) ** 2).sum(axis=1).mean())) if means else float("nan")


def _inefficiency(observed: Observed, factor: float) -> float:
    """1 + 2 sum_l (1 - l/K) rho_l of the standardised errors about zero, summed until rho falls below 0.05.

    About zero and not about their mean: an error that stays the same in all frames is the worst kind.
    """
    with np.errstate(invalid="ignore"):
        sigma = np.sqrt(factor * observed.covariances[..., (0, 1), (0, 1)])
        e = np.clip(observed.errors / sigma, -3.0, 3.0)
    power = np.nanmean(e**2)
    total = 1.0
    for lag in range(1, len(e) // 2):
        products = e[lag:] * e[:-lag]
        known = np.isfinite(products)
        if not known.any():
            break
        rho = float(products[known].mean() / power)
        if rho < 0.05:
            break
        total += 2.0 * (1.0 - lag / len(e)) * rho
    return total
