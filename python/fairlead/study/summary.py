# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What the runs of a setting say: mean, median, interval, and pairs of methods, docs/study.md section 4."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fairlead.study.scores import COLUMNS, ERRORS
from fairlead.study.settings import Setting

Rows = Mapping[tuple[str, str], Mapping[str, np.ndarray]]
"""(setting, method) -> column -> one value per run."""

RESAMPLES = 1000
COMPARED_WITH = ("epnp", "single", "window")
_SEED = 20_240_811


@dataclass(frozen=True, kw_only=True)
class Statistic:
    """Of one number over the runs of a setting; runs where it is NaN are left out."""

    mean: float
    median: float
    low: float
    """95 % interval of the mean: percentile bootstrap over the runs."""
    high: float
    runs: int
    """That have the number."""


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """One method against another on the same runs."""

    ratio: float
    """Mean error over mean error [-]."""
    low: float
    """95 % interval: runs drawn anew in pairs."""
    high: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Line:
    """All that is said of one method in one setting."""

    setting: Setting
    method: str
    statistics: Mapping[str, Statistic]
    """By column."""
    against: Mapping[tuple[str, str], Comparison]
    """(other method, error) -> comparison."""
    bound_ratio: Mapping[str, float]
    """rms error over the bound's, docs/bound.md eq. (16), by error."""


def summarise(settings: Sequence[Setting], methods: Sequence[str], rows: Rows) -> list[Line]:
    """One line per setting and method that has rows, in order."""
    return [
        _line(setting, method, rows) for setting in settings for method in methods if (setting.name, method) in rows
    ]


def _line(setting: Setting, method: str, rows: Rows) -> Line:
    mine = rows[setting.name, method]
    against: dict[tuple[str, str], Comparison] = {}
    for other in COMPARED_WITH:
        theirs = rows.get((setting.name, other))
        if theirs is not None and other != method and method != "bound":
            pair = _common_runs(mine, theirs)
            against |= {(other, error): compare(pair[0][error], pair[1][error]) for error in (*ERRORS, *_PENALISED)}
    bound = rows.get((setting.name, "bound"))
    return Line(
        setting=setting,
        method=method,
        statistics={name: describe(mine[name]) for name in COLUMNS},
        against=against,
        bound_ratio={} if bound is None else {name: _rms_ratio(mine[name], bound[name]) for name in _RMS},
    )


_PENALISED = ("rotation_penalised_deg", "translation_penalised_m")
_RMS = ("rotation_rms_deg", "translation_rms_m", "landmark_rms_m")


def describe(values: np.ndarray) -> Statistic:
    """Mean, median and the interval of the mean."""
    known = values[np.isfinite(values)]
    if not len(known):
        nan = float("nan")
        return Statistic(mean=nan, median=nan, low=nan, high=nan, runs=0)
    low, high = np.quantile(_weights(len(known)) @ known, [0.025, 0.975])
    return Statistic(
        mean=float(known.mean()), median=float(np.median(known)), low=float(low), high=float(high), runs=len(known)
    )


def compare(mine: np.ndarray, theirs: np.ndarray) -> Comparison:
    """Ratio of the means over the runs where both have an error."""
    both = np.isfinite(mine) & np.isfinite(theirs)
    if not both.any() or not theirs[both].any():
        return Comparison(ratio=float("nan"), low=float("nan"), high=float("nan"))
    a, b = mine[both], theirs[both]
    W = _weights(len(a))
    low, high = np.quantile((W @ a) / (W @ b), [0.025, 0.975])
    return Comparison(ratio=float(a.mean() / b.mean()), low=float(low), high=float(high))


def crossing(x: Sequence[float], ratio: Sequence[float]) -> float | None:
    """Where a ratio passes 1 for the last time, interpolated in log x; None if it never does."""
    above = np.asarray(ratio) >= 1.0
    others = np.flatnonzero(above != above[-1])
    if not others.size:
        return None
    i = int(others[-1])
    share = (1.0 - ratio[i]) / (ratio[i + 1] - ratio[i])
    return float(np.exp(np.log(x[i]) + share * (np.log(x[i + 1]) - np.log(x[i]))))


def _common_runs(
    mine: Mapping[str, np.ndarray], theirs: Mapping[str, np.ndarray]
) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    _, a, b = np.intersect1d(mine["run"], theirs["run"], return_indices=True)
    return {name: each[a] for name, each in mine.items()}, {name: each[b] for name, each in theirs.items()}


def _rms_ratio(mine: np.ndarray, bound: np.ndarray) -> float:
    known = np.isfinite(mine)
    return float(np.sqrt((mine[known] ** 2).mean() / (bound**2).mean())) if known.any() else float("nan")


@lru_cache(maxsize=8)
def _weights(runs: int) -> np.ndarray:
    """How often each run is drawn in each resample, divided by their number, (RESAMPLES, runs)."""
    counts = np.random.default_rng(_SEED).multinomial(runs, np.full(runs, 1.0 / runs), size=RESAMPLES)
    return counts / runs
