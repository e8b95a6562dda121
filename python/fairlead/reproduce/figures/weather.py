# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Small multiples: a column per kind of weather, a line per network."""

from collections.abc import Mapping, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import PercentFormatter

from fairlead.evaluate.figures.style import INK, WIDTH_INCHES, styled
from fairlead.reproduce.figures.look import network_colour
from fairlead.study.figures.look import log_values

Row = Mapping[str, object]
CLEAR = "clear"
_SHOWN = {
    "median_px": "landmarks [px]",
    "map_m": "translation [m]",
    "map_failed": "failed",
    "map_nees_median": "NEES / 6 [-]",
}


@styled
def draw_weather(rows: Sequence[Row]) -> Figure:
    """From top to bottom: the network, the tracker, its failures, whether its covariance is true."""
    kinds = [kind for kind in dict.fromkeys(str(row["kind"]) for row in rows) if kind != CLEAR] or [CLEAR]
    networks = list(dict.fromkeys(str(row["network"]) for row in rows))
    figure = Figure(figsize=(WIDTH_INCHES, 5.8), layout="constrained")
    panels = figure.subplots(4, len(kinds), sharex=True, sharey="row", squeeze=False)
    for line, kind in zip(panels.T, kinds, strict=True):
        for i, network in enumerate(networks):
            mine = [row for row in rows if row["network"] == network and row["kind"] in (kind, CLEAR)]
            mine.sort(key=lambda row: float(row["strength"]))  # type: ignore[arg-type]
            for axes, key in zip(line, _SHOWN, strict=True):
                _line(axes, mine, key, network_colour(i))
        line[3].axhline(1.0, color=INK, lw=0.8)
        line[0].set_title(kind)
        line[3].set_xlabel("strength")
    for axes, (key, label) in zip(panels[:, 0], _SHOWN.items(), strict=True):
        axes.set_ylabel(label)
        if key == "map_failed":
            axes.set_ylim(-0.03, 1.03)
            axes.yaxis.set_major_formatter(PercentFormatter(1.0))
        elif key == "map_m":
            axes.set_ylim(bottom=0.0)
        else:
            log_values(axes)
    figure.align_ylabels(panels[:, 0])
    handles = [Line2D([], [], color=network_colour(i), marker="o", ms=3.5, label=n) for i, n in enumerate(networks)]
    figure.legend(handles=handles, loc="outside upper left", ncols=4)
    return figure


def _line(axes: Axes, rows: Sequence[Row], key: str, colour: str) -> None:
    x = [float(row["strength"]) for row in rows]  # type: ignore[arg-type]
    y = [_value(row, key) for row in rows]  # type: ignore[arg-type]
    axes.plot(x, y, color=colour, marker="o", ms=3.2)


def _value(row: Row, key: str) -> float:
    value = row.get(key)
    return float(value) if isinstance(value, int | float) else float("nan")
