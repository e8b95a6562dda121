# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Curves over time that stay legible, and small, however long the run is."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool
from matplotlib.axes import Axes

from fairlead.evaluate.summary import Series, quantile

MAX_FRAMES = 300
"""Longer runs are drawn as the median of neighbouring frames with a band about it."""
BINS = 150


@dataclass(frozen=True, kw_only=True, eq=False)
class Bins:
    """Quantiles of equal numbers of neighbouring frames; NaN where none of them has a value."""

    seconds: Series
    low: Series
    middle: Series
    high: Series


def binned(seconds: Series, values: Series, *, share: float, count: int = BINS) -> Bins:
    """Median and the band that holds this share of the values, in `count` parts of the run."""
    edges = np.linspace(0, len(values), count + 1).astype(np.int64)
    rows: list[tuple[float, float, float, float]] = []
    for first, last in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        part = values[first:last]
        part = part[~np.isnan(part)]
        middle = float(np.mean(seconds[first:last]))
        if part.size:
            tail = 0.5 * (1.0 - share)
            rows.append((middle, quantile(part, tail), float(np.median(part)), quantile(part, 1.0 - tail)))
        else:
            rows.append((middle, np.nan, np.nan, np.nan))
    table = np.array(rows, dtype=np.float64)
    return Bins(seconds=table[:, 0], low=table[:, 1], middle=table[:, 2], high=table[:, 3])


def is_long(count: int) -> bool:
    """Whether a run of this many frames is drawn in bins."""
    return count > MAX_FRAMES


def draw_curve(
    axes: Axes, seconds: Series, values: Series, colour: str, *, label: str = "", share: float = 0.8, count: int = BINS
) -> None:
    """Every frame of a short run (with dots where there are few); of a long one the median and a band of the share."""
    if is_long(len(values)):
        bins = binned(seconds, values, share=share, count=count)
        axes.fill_between(bins.seconds, bins.low, bins.high, color=colour, alpha=0.22, linewidth=0.0)
        axes.plot(bins.seconds, bins.middle, color=colour, label=label)
        return
    dots: dict[str, Any] = {"marker": "o", "markersize": 2.6} if len(values) <= 60 else {}
    axes.plot(seconds, values, color=colour, label=label, **dots)


def spans(seconds: Series, flags: Bool[np.ndarray, " k"]) -> list[tuple[float, float]]:
    """(start, duration) of each run of flagged frames; at least 1/200 of the whole time, so that it is seen."""
    if not flags.any():
        return []
    step = float(np.median(np.diff(seconds))) if len(seconds) > 1 else 1.0
    least = max(float(np.ptp(seconds)) / 200.0, 1e-9)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    starts, ends = seconds[edges[::2]], seconds[edges[1::2] - 1]
    return [
        (float(start) - 0.5 * step, max(float(end - start) + step, least))
        for start, end in zip(starts, ends, strict=True)
    ]
