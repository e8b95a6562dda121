# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Errors over the bound: a panel per sequence, a line per kind of errors."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from fairlead.evaluate.figures.style import INK, MUTED, WIDTH_INCHES, styled
from fairlead.reproduce.content import Row
from fairlead.reproduce.figures.look import LOOKS
from fairlead.reproduce.methods import BATCH, LABELS, ONLINE

TARGET = 1.3
_MARKERS = (("rotation", "o"), ("translation", "s"), ("model", "D"))
_APART = {ONLINE: 0.16, BATCH: -0.16}


@styled
def draw_gap(rows: Sequence[Row]) -> Figure:
    """Kinds from top to bottom as they come; online above, batch below."""
    kinds = {str(row["errors"]): str(row["label"]) for row in rows}
    sequences = list(dict.fromkeys(str(row["sequence"]) for row in rows))
    figure = Figure(figsize=(WIDTH_INCHES, 0.36 * len(kinds) + 1.1), layout="constrained")
    panels = figure.subplots(1, len(sequences), sharex=True, sharey=True, squeeze=False)[0]
    place = np.arange(len(kinds))[::-1]
    for axes, sequence in zip(panels, sequences, strict=True):
        for method, apart in _APART.items():
            mine = [row for row in rows if row["sequence"] == sequence and row["method"] == method]
            for key, marker in _MARKERS:
                values = [float(row[key] or np.nan) for row in mine]
                colour = LOOKS[method].colour
                axes.plot(values, place + apart, ls="", marker=marker, ms=3.6, mfc="none", mec=colour, mew=1.1)
        _frame(axes, sequence)
    panels[0].set_yticks(place, list(kinds.values()))
    panels[0].set_ylim(-0.6, len(kinds) - 0.4)
    _legend(figure)
    return figure


def _frame(axes: Axes, title: str) -> None:
    axes.axvline(1.0, color=INK, lw=0.8)
    axes.axvline(TARGET, color=MUTED, lw=0.8, ls=(0, (3, 2)))
    axes.set_title(title)
    axes.set_xlabel("rms / bound")
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(FixedLocator([0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0]))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.tick_params(axis="y", length=0)


def _legend(figure: Figure) -> None:
    handles = [Line2D([], [], color=LOOKS[method].colour, lw=1.7, label=LABELS[method]) for method in _APART]
    handles += [Line2D([], [], ls="", marker=m, ms=4, mfc="none", mec=INK, label=key) for key, m in _MARKERS]
    figure.legend(handles=handles, loc="outside upper left", ncols=len(handles), columnspacing=1.2)
