# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""How each method is drawn: families have a hue, the same as in the reports; members differ by the line."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from fairlead.evaluate.figures.style import COLOURS, INK, MUTED, plain_decades
from fairlead.study.methods import METHODS
from fairlead.study.settings import Setting
from fairlead.study.summary import Line

DPI = 160
LABELS = {method.name: method.label for method in METHODS}


@dataclass(frozen=True, kw_only=True)
class Look:
    """Of one method's line."""

    colour: str
    dashes: Any = "-"
    width: float = 1.5
    marker: str = "o"


LOOKS: dict[str, Look] = {
    "epnp": Look(colour=COLOURS["epnp"]),
    "single": Look(colour=COLOURS["epnp"], dashes=(0, (4, 2)), width=1.1, marker=""),
    "window": Look(colour=COLOURS["window"]),
    "window-5": Look(colour=COLOURS["window"], dashes=(0, (4, 2)), marker="s"),
    "window-3": Look(colour=COLOURS["window"], dashes=(0, (1, 1.5)), marker="^"),
    "free": Look(colour=COLOURS["window"], dashes=(0, (6, 2, 1, 2)), marker="D"),
    "map": Look(colour=COLOURS["map"], width=2.2),
    "online": Look(colour=COLOURS["map"], dashes=(0, (4, 2)), marker=""),
    "true-model": Look(colour=INK, dashes=(0, (1, 1.5)), width=1.1, marker=""),
    "bound": Look(colour=COLOURS["bound"], width=1.0, marker=""),
}

Pick = Callable[[Line], tuple[float, float, float]]
"""Value and interval of a line."""


def draw_curve(axes: Axes, x: Sequence[float], lines: Sequence[Line], pick: Pick, *, faint: bool = False) -> None:
    """One method over the settings, with its interval."""
    if not lines:
        return
    look = LOOKS[lines[0].method]
    value, low, high = np.array([pick(line) for line in lines]).T
    axes.fill_between(x, low, high, color=look.colour, alpha=0.16, lw=0)
    axes.plot(
        x,
        value,
        color=look.colour,
        ls=look.dashes,
        lw=look.width,
        marker=look.marker,
        ms=3.2,
        alpha=0.55 if faint else 1.0,
        label=LABELS[lines[0].method],
    )


def by_method(lines: Sequence[Line], settings: Sequence[Setting]) -> dict[str, list[Line]]:
    """The lines of each method in the order of the settings, of those methods that have all of them."""
    place = {setting.name: i for i, setting in enumerate(settings)}
    found: dict[str, list[Line]] = {}
    for line in sorted(
        (each for each in lines if each.setting.name in place), key=lambda each: place[each.setting.name]
    ):
        found.setdefault(line.method, []).append(line)
    return {method: each for method, each in found.items() if len(each) == len(settings)}


def log_values(axes: Axes) -> None:
    """A logarithmic y axis with numbers at 1, 2 and 5 of every decade."""
    axes.set_yscale("log")
    plain_decades(axes.yaxis)
    axes.yaxis.set_minor_formatter(FuncFormatter(lambda value, _: f"{value:g}" if f"{value:.0e}"[0] in "25" else ""))
    axes.tick_params(axis="y", which="minor", labelsize=7, labelcolor=MUTED)


def legend(figure: Figure, shown: Sequence[str], title: str, ncols: int = 4) -> None:
    """All methods of a figure, and the bound, above the panels."""
    handles: list[Line2D | Patch] = []
    for name in shown:
        look = LOOKS[name]
        if name == "bound":
            handles.append(Patch(color=look.colour, alpha=0.3, lw=0, label=f"below the {LABELS[name]}"))
            continue
        dashes: Any = look.dashes
        handles.append(
            Line2D([], [], color=look.colour, ls=dashes, lw=look.width, marker=look.marker, ms=3.5, label=LABELS[name])
        )
    figure.legend(
        handles=handles, loc="outside upper left", ncols=ncols, columnspacing=1.4, title=title, alignment="left"
    )


def log_ticks(axes: Axes, values: Sequence[float]) -> None:
    """A logarithmic x axis with a tick at every setting."""
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(FixedLocator(list(values)))
    axes.xaxis.set_minor_locator(NullLocator())
    plain_decades(axes.xaxis)
    axes.set_xlim(values[0] / 1.08, values[-1] * 1.08)
    axes.tick_params(axis="x", labelsize=6.8)


def save(figure: Figure, path: Path) -> Path:
    """As PNG on white."""
    figure.savefig(path, dpi=DPI, facecolor="white")
    return path
