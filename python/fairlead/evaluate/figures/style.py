# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""One look for all figures: a colour per method, quiet axes, units on them.

Figures are matplotlib objects without pyplot, so nothing global is touched; matplotlib is imported here only.
"""

import warnings
from collections.abc import Callable, Sequence
from typing import Any, Literal, ParamSpec, TypeVar

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from fairlead.evaluate.summary import Series

WIDTH_INCHES = 8.4
"""Full width of the report's column: text of 9 pt is then 7 pt on A4 and 15 px on a screen."""

INK = "#1b2430"
MUTED = "#6b7686"
GRID = "#dfe4ea"
COLOURS: dict[str, str] = {
    "epnp": "#c77700",
    "window": "#00936b",
    "map": "#0b66c3",
    "refine": "#b0408c",
    "truth": INK,
    "bound": "#8a94a3",
}
"""Told apart by people with any colour vision, on white and on black (after Okabe and Ito 2008)."""
OTHERS = ("#56789a", "#a0522d", "#5f7d00", "#7a5cc0")
"""For methods without a colour of their own, in order."""

P = ParamSpec("P")
F = TypeVar("F")

_RC: Any = {
    "font.size": 9.0,
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "mathtext.fontset": "dejavusans",
    "text.color": INK,
    "axes.edgecolor": MUTED,
    "axes.labelcolor": INK,
    "axes.titlesize": 9.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.titlepad": 6.0,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "axes.unicode_minus": True,
    "grid.color": GRID,
    "grid.linewidth": 0.6,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.major.size": 3.0,
    "ytick.major.size": 3.0,
    "xtick.minor.size": 0.0,
    "ytick.minor.size": 0.0,
    "legend.frameon": False,
    "legend.handlelength": 1.6,
    "lines.linewidth": 1.15,
    "lines.solid_capstyle": "round",
    "figure.facecolor": "none",
    "axes.facecolor": "none",
    "savefig.facecolor": "none",
    "svg.fonttype": "none",
    "text.parse_math": False,
    "svg.hashsalt": "fairlead",
}


def styled(draw: Callable[P, F]) -> Callable[P, F]:
    """Draw with these settings, whatever the caller's are."""

    def wrapped(*args: P.args, **kwargs: P.kwargs) -> F:
        with matplotlib.rc_context(_RC), warnings.catch_warnings():
            # Names may be in any script; the page's fonts draw them, matplotlib's only measure.
            warnings.filterwarnings("ignore", message=r"Glyph \d+ .* missing from font")
            return draw(*args, **kwargs)

    return wrapped


def colour_of(method: str, methods: Sequence[str]) -> str:
    """The method's own colour, by the first word of its label; others take turns."""
    word = method.split()[0].lower() if method.split() else method
    if word in COLOURS:
        return COLOURS[word]
    strangers = [name for name in methods if not name.split() or name.split()[0].lower() not in COLOURS]
    return OTHERS[strangers.index(method) % len(OTHERS)] if method in strangers else OTHERS[0]


def new_figure(height_inches: float) -> Figure:
    """An empty figure of full width."""
    return Figure(figsize=(WIDTH_INCHES, height_inches), layout="constrained")


def log_if_wide(axes: Axes, series: Sequence[Series], axis: Literal["x", "y"] = "y") -> None:
    """Logarithmic where a linear axis would flatten one of the series, else from zero."""
    values = np.concatenate([np.ravel(each) for each in series]) if series else np.zeros(0)
    values = values[np.isfinite(values) & (values > 0.0)]
    set_scale, set_limit = (axes.set_yscale, axes.set_ylim) if axis == "y" else (axes.set_xscale, axes.set_xlim)
    if values.size > 1 and np.quantile(values, 0.99) > 10.0 * np.median(values):
        set_scale("log")
        set_limit(float(np.quantile(values, 0.005)) * 0.6, None)
        plain_decades(axes.yaxis if axis == "y" else axes.xaxis)
    else:
        set_limit(0.0, None)


def plain_decades(axis: Axis) -> None:
    """0.01, 0.1, 1, 10 on a logarithmic axis instead of powers of ten."""
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def legend_above(figure: Figure, axes: Axes) -> None:
    """One legend for all panels, in a line above them."""
    handles, labels = axes.get_legend_handles_labels()
    if handles:
        figure.legend(
            handles, labels, loc="outside upper left", ncols=min(len(labels), 6), columnspacing=1.4, markerscale=1.6
        )
