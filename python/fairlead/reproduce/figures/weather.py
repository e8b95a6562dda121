# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Small multiples: a column per kind of weather, a line per network."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fairlead.evaluate.figures.style import INK, WIDTH_INCHES, styled
from fairlead.reproduce.figures.look import network_colour
from fairlead.study.figures.look import log_values

Row = Mapping[str, object]
CLEAR = "clear"


@styled
def draw_weather(rows: Sequence[Row]) -> Figure:
    """Above the network, in the middle the tracker, below whether its covariance is true."""
    kinds = [kind for kind in dict.fromkeys(str(row["kind"]) for row in rows) if kind != CLEAR] or [CLEAR]
    networks = list(dict.fromkeys(str(row["network"]) for row in rows))
    figure = Figure(figsize=(WIDTH_INCHES, 4.8), layout="constrained")
    panels = figure.subplots(3, len(kinds), sharex=True, sharey="row", squeeze=False)
    for line, kind in zip(panels.T, kinds, strict=True):
        for i, network in enumerate(networks):
            mine = [row for row in rows if row["network"] == network and row["kind"] in (kind, CLEAR)]
            mine.sort(key=lambda row: float(row["strength"]))  # type: ignore[arg-type]
            for axes, key in zip(line, ("mean_px", "map_m", "map_nees"), strict=True):
                _line(axes, mine, key, network_colour(i))
        line[2].axhline(1.0, color=INK, lw=0.8)
        line[0].set_title(kind)
        line[2].set_xlabel("strength")
    for axes, label in zip(panels[:, 0], ("landmarks [px]", "translation [m]", "NEES / 6 [-]"), strict=True):
        axes.set_ylabel(label)
        log_values(axes)
    figure.align_ylabels(panels[:, 0])
    handles = [Line2D([], [], color=network_colour(i), marker="o", ms=3.5, label=n) for i, n in enumerate(networks)]
    figure.legend(handles=handles, loc="outside upper left", ncols=4)
    return figure


def _line(axes: Axes, rows: Sequence[Row], key: str, colour: str) -> None:
    x = [float(row["strength"]) for row in rows]  # type: ignore[arg-type]
    y = [float(row.get(key) or np.nan) for row in rows]  # type: ignore[arg-type]
    axes.plot(x, y, color=colour, marker="o", ms=3.2)
