# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Errors over the flight: pose of one told model, model as the mean over all of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fairlead.evaluate.figures.style import WIDTH_INCHES, styled
from fairlead.reproduce.figures.look import LOOKS, legend
from fairlead.reproduce.methods import BOUND, EPNP, ONLINE
from fairlead.study.figures.look import log_values

HALF = 5
"""Frames to either side that a line is smoothed over."""
FAINT = (EPNP, ONLINE)
"""Drawn frame by frame as well."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Curves:
    """Of one sequence; method -> (k,), NaN where there is no pose."""

    title: str
    seconds: np.ndarray
    rotation_deg: Mapping[str, np.ndarray]
    translation_m: Mapping[str, np.ndarray]
    model_m: Mapping[str, np.ndarray]
    """Mean over told models."""
    told_m: float
    """Of the model before the first view, mean over told models."""


@styled
def draw_curves(rows: Sequence[Curves]) -> Figure:
    """A row per sequence: rotation, translation, model."""
    figure = Figure(figsize=(WIDTH_INCHES, 1.75 * len(rows) + 0.5), layout="constrained")
    panels = figure.subplots(len(rows), 3, squeeze=False)
    for line, curves in zip(panels, rows, strict=True):
        for axes, values in zip(line, (curves.rotation_deg, curves.translation_m), strict=False):
            _draw(axes, curves.seconds, values)
        _draw_model(line[2], curves)
        line[0].set_ylabel(curves.title, fontweight="bold")
    for axes, title in zip(
        panels[0], ("rotation error [deg]", "translation error [m]", "model error [m]"), strict=True
    ):
        axes.set_title(title)
    for axes in panels[-1]:
        axes.set_xlabel("time [s]")
    legend(figure, tuple(rows[0].rotation_deg))
    return figure


def running_rms(values: np.ndarray, half: int = HALF) -> np.ndarray:
    """Root mean square over a frame and `half` to either side; NaN where none of them has a value."""
    known = np.isfinite(values)
    kernel = np.ones(2 * half + 1)
    squares = np.convolve(np.where(known, values**2, 0.0), kernel, mode="same")
    counts = np.convolve(known.astype(float), kernel, mode="same")
    return np.where(known, np.sqrt(squares / np.maximum(counts, 1.0)), np.nan)


def _draw_model(axes: Axes, curves: Curves) -> None:
    axes.axhline(curves.told_m, color=LOOKS["epnp"].colour, lw=LOOKS["epnp"].width)
    for method, series in curves.model_m.items():
        look = LOOKS[method]
        axes.plot(curves.seconds, series, color=look.colour, ls=look.dashes, lw=look.width)
    axes.set_ylim(0.0, 2.5 * curves.told_m)
    axes.set_xlim(curves.seconds[0], curves.seconds[-1])


def _draw(axes: Axes, seconds: np.ndarray, values: Mapping[str, np.ndarray]) -> None:
    for method, series in values.items():
        look = LOOKS[method]
        if method in FAINT:
            axes.plot(seconds, series, color=look.colour, lw=0.5, alpha=0.3)
        smooth = series if method == BOUND else running_rms(series)
        axes.plot(seconds, smooth, color=look.colour, ls=look.dashes, lw=look.width)
    known = np.concatenate([running_rms(series) for series in values.values()])
    known = known[known > 0.0]
    log_values(axes)
    if known.size:
        low, high = np.quantile(known, [0.005, 0.995])
        axes.set_ylim(0.5 * low, 1.4 * high)
    axes.set_xlim(seconds[0], seconds[-1])
