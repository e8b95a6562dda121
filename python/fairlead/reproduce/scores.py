# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""One track to numbers, many seeds to means with intervals and paired comparisons. docs/reproduce.md section 6."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fairlead.evaluate.failures import FAILURE_ROTATION_DEG, FAILURE_TRANSLATION_PERCENT, failed_frames
from fairlead.evaluate.pose import range_m, rotation_error_deg, translation_error_m
from fairlead.reproduce.bounds import Bound
from fairlead.reproduce.methods import Flight, Track, model_error_m
from fairlead.study.scores import normalised_squares, pose_squares
from fairlead.study.summary import compare, describe

ERRORS = ("rotation_deg", "translation_m", "model_m")


@dataclass(frozen=True, kw_only=True, eq=False)
class Errors:
    """Frame by frame."""

    rotation_deg: np.ndarray
    translation_m: np.ndarray
    range_m: np.ndarray
    failed: np.ndarray
    nees: np.ndarray
    """Per degree of freedom; NaN where there is no covariance."""
    sigma_rotation_deg: np.ndarray
    """What the covariance says."""
    sigma_translation_m: np.ndarray


def errors_of(track: Track, T_true: np.ndarray) -> Errors:
    """Against truth; NaN where there is no pose."""
    T, S = track.T_camera_target, track.covariances
    rotation, translation, distance = rotation_error_deg(T, T_true), translation_error_m(T, T_true), range_m(T_true)
    with np.errstate(invalid="ignore"):
        sigma = [np.sqrt(np.trace(S[:, a, a], axis1=1, axis2=2)) for a in (slice(3, 6), slice(0, 3))]
    return Errors(
        rotation_deg=rotation,
        translation_m=translation,
        range_m=distance,
        failed=failed_frames(rotation, 100.0 * translation / distance),
        nees=pose_squares(T, T_true, S) / 6.0,
        sigma_rotation_deg=np.degrees(sigma[0]),
        sigma_translation_m=sigma[1],
    )


def score(track: Track, flight: Flight) -> dict[str, float]:
    """The numbers of one seed; means over frames with a pose, and penalised means over all frames."""
    e = errors_of(track, flight.T_true)
    limit_m = 0.01 * FAILURE_TRANSLATION_PERCENT * e.range_m
    row = {
        "rotation_deg": _mean(e.rotation_deg),
        "translation_m": _mean(e.translation_m),
        "translation_percent": _mean(100.0 * e.translation_m / e.range_m),
        "rotation_rms_deg": rms(e.rotation_deg),
        "translation_rms_m": rms(e.translation_m),
        "rotation_all_deg": float(np.where(e.failed, FAILURE_ROTATION_DEG, e.rotation_deg).mean()),
        "translation_all_m": float(np.where(e.failed, limit_m, e.translation_m).mean()),
        "translation_since_m": _since_first(np.where(e.failed, limit_m, e.translation_m), e.rotation_deg),
        "coverage": float(np.isfinite(e.rotation_deg).mean()),
        "failed": float(e.failed.mean()),
        "wrong": float((e.failed & np.isfinite(e.rotation_deg)).mean()),
        "pose_nees": _mean(e.nees),
        "pose_nees_median": _median(e.nees),
        "sigma_translation_m": rms(e.sigma_translation_m),
        "sigma_rotation_deg": rms(e.sigma_rotation_deg),
        "model_m": float(track.model_m[-1]),
        "model_aligned_m": model_error_m(track.X, flight.X_true, aligned=True),
        "model_before_m": model_error_m(flight.told.positions, flight.X_true),
        "model_before_aligned_m": model_error_m(flight.told.positions, flight.X_true, aligned=True),
        "model_rms_m": float(np.sqrt(((track.X - flight.X_true) ** 2).sum(axis=1).mean())),
        "update_ms": float(np.median(track.update_ms)),
        "update_mean_ms": float(np.mean(track.update_ms)),
        "model_nees": float("nan"),
    }
    if track.X_covariance.size:
        flat = (track.X - flight.X_true).reshape(1, -1)
        row["model_nees"] = float(normalised_squares(flat, track.X_covariance[None])[0]) / flat.shape[1]
    return row


def on_common_frames(mine: Track, theirs: Track, flight: Flight) -> tuple[dict[str, float], dict[str, float]]:
    """Both on the frames where the other has a pose; where ours has none there, it counts with the limits."""
    a, b = errors_of(mine, flight.T_true), errors_of(theirs, flight.T_true)
    common = np.isfinite(b.rotation_deg)
    none = np.isnan(a.rotation_deg)
    limit_m = 0.01 * FAILURE_TRANSLATION_PERCENT * a.range_m
    rows: list[dict[str, float]] = []
    for errors, track, silent in ((a, mine, none), (b, theirs, np.zeros_like(none))):
        rotation = np.where(silent, FAILURE_ROTATION_DEG, errors.rotation_deg)[common]
        translation = np.where(silent, limit_m, errors.translation_m)[common]
        rows.append(
            {"rotation_deg": _mean(rotation), "translation_m": _mean(translation), "model_m": float(track.model_m[-1])}
        )
    return rows[0], rows[1]


def summarise(rows: Sequence[dict[str, float]]) -> dict[str, float]:
    """Mean over seeds of every number, with the 95 % interval of the mean."""
    found: dict[str, float] = {"seeds": float(len(rows))}
    for name in rows[0]:
        statistic = describe(np.array([row[name] for row in rows]))
        found[name] = statistic.mean
        found[f"{name}_low95"], found[f"{name}_high95"] = statistic.low, statistic.high
    return found


@dataclass(frozen=True, kw_only=True)
class Paired:
    """Ours against another on the same seeds."""

    ratio: float
    """Mean error over mean error [-]."""
    low: float
    high: float
    """95 % interval of the ratio, seeds drawn anew in pairs."""
    worse: float
    """Share of the seeds in which ours is worse [-]."""

    @property
    def is_worse(self) -> bool:
        """Whether the interval lies above 1; an unknown ratio is no proof of anything and counts as worse."""
        return not self.low <= 1.0


def paired(mine: Sequence[float], theirs: Sequence[float]) -> Paired:
    """Compare seed by seed; a seed that ours has no number for counts as worse."""
    a, b = np.array(mine, dtype=np.float64), np.array(theirs, dtype=np.float64)
    known = np.isfinite(b)
    if not known.any():
        return Paired(ratio=np.nan, low=np.nan, high=np.nan, worse=np.nan)
    comparison = compare(a, b)
    worse = float((~(a[known] <= b[known])).mean())
    return Paired(ratio=comparison.ratio, low=comparison.low, high=comparison.high, worse=worse)


def over_bound(tracks: Sequence[Track], flights: Sequence[Flight], floor: Bound, first: int = 0) -> dict[str, float]:
    """Root mean squares of rotation, translation and model over the bound's, from frame `first` on.

    Over frames with a pose and a bound, then over seeds; a method that has none gets NaN.
    """
    errors = [errors_of(track, flight.T_true) for track, flight in zip(tracks, flights, strict=True)]
    bounded = np.isfinite(floor.rotation_rms_deg) & (np.arange(len(floor.rotation_rms_deg)) >= first)
    X = [rms(np.linalg.norm(a.X - b.X_true, axis=1)) for a, b in zip(tracks, flights, strict=True)]
    found = {
        "rotation": [rms(each.rotation_deg[bounded]) for each in errors],
        "translation": [rms(each.translation_m[bounded]) for each in errors],
        "model": X,
    }
    least = {"rotation": rms(floor.rotation_rms_deg[bounded]), "translation": rms(floor.translation_rms_m[bounded])}
    least["model"] = floor.model_rms_m
    return {name: rms(np.array(values)) / least[name] for name, values in found.items()}


def _since_first(values: np.ndarray, rotation_deg: np.ndarray) -> float:
    """Mean from the first frame with a pose on; NaN where there is none."""
    known = np.flatnonzero(np.isfinite(rotation_deg))
    return float(values[known[0] :].mean()) if known.size else float("nan")


def _mean(values: np.ndarray) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if known.size else float("nan")


def _median(values: np.ndarray) -> float:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if known.size else float("nan")


def rms(values: np.ndarray) -> float:
    """Root mean square of what is known; NaN where nothing is."""
    known = values[np.isfinite(values)]
    return float(np.sqrt((known**2).mean())) if known.size else float("nan")
