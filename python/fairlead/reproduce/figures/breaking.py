# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Error, failures and truthfulness against what makes a flight hard."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fairlead.evaluate.figures.style import INK, WIDTH_INCHES, styled
from fairlead.reproduce.figures.look import LOOKS, legend
from fairlead.reproduce.methods import WINDOW
from fairlead.study.figures.look import log_values

Row = Mapping[str, object]


@dataclass(frozen=True, kw_only=True, eq=False)
class Axis:
    """One thing that is varied."""

    label: str
    levels: Sequence[float]
    rows: Sequence[Row]
    """level, method and the numbers."""
    methods: tuple[str, ...]


@styled
def draw_breaking(columns: Sequence[Axis]) -> Figure:
    """A column per axis; rows: error, failures, error over what is stated."""
    figure = Figure(figsize=(WIDTH_INCHES, 5.6), layout="constrained")
    panels = figure.subplots(3, len(columns), sharex="col", sharey="row", squeeze=False, height_ratios=(1.2, 0.8, 1.0))
    for line, column in zip(panels.T, columns, strict=True):
        for axes, key, scale in zip(line, ("translation_all_m", "failed", "truthful"), (1.0, 100.0, 1.0), strict=True):
            _draw(axes, column, key, scale)
        line[2].set_xlabel(column.label)
        line[2].axhline(1.0, color=INK, lw=0.8)
    for axes, label in zip(
        panels[:, 0], ("translation error [m]", "failed frames [%]", "error / stated [-]"), strict=True
    ):
        axes.set_ylabel(label)
    log_values(panels[0, 0])
    log_values(panels[2, 0])
    panels[1, 0].set_ylim(-3.0, 103.0)
    figure.align_ylabels(panels[:, 0])
    legend(figure, columns[0].methods)
    return figure


def _draw(axes: Axes, column: Axis, key: str, scale: float) -> None:
    place = np.arange(len(column.levels))
    for method in column.methods:
        rows = [row for row in column.rows if row["method"] == method]
        values = [scale * float(row[key]) for row in rows]  # type: ignore[arg-type]
        look = LOOKS[method]
        axes.plot(place, values, color=look.colour, lw=look.width, marker="o", ms=3.0)
        if key == "translation_all_m" and method == WINDOW:
            since = [float(row["translation_since_m"]) for row in rows]  # type: ignore[arg-type]
            axes.plot(place, since, color=look.colour, lw=look.width, ls=(0, (1, 1.5)))
    axes.set_xticks(place, [f"{level:g}" for level in column.levels])
