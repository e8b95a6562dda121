# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Errors against noise or angle: above in degrees and metres over the bound, below in units of EPnP's."""

from collections.abc import Mapping, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fairlead.evaluate.figures.style import INK, new_figure, styled
from fairlead.study.figures.look import LOOKS, Pick, by_method, draw_curve, legend, log_ticks, log_values
from fairlead.study.settings import Setting
from fairlead.study.summary import Line, crossing

PANELS = (("rotation_deg", "rotation [deg]"), ("translation_m", "translation [m]"), ("landmark_m", "model [m]"))
SHOWN = ("epnp", "single", "window", "window-5", "true-model", "online", "map")
SENSITIVITY = ("single", "window", "window-5", "window-3", "free", "map")
NO_MODEL = ("single", "true-model")
"""They say nothing of the model."""

ByMethod = Mapping[str, Sequence[Line]]


def error_of(name: str) -> Pick:
    """Mean and interval of an error."""

    def pick(line: Line) -> tuple[float, float, float]:
        statistic = line.statistics[name]
        return statistic.mean, statistic.low, statistic.high

    return pick


def ratio_of(name: str, other: str = "epnp") -> Pick:
    """The error in units of another method's on the same runs."""

    def pick(line: Line) -> tuple[float, float, float]:
        comparison = line.against[other, name]
        return comparison.ratio, comparison.low, comparison.high

    return pick


@styled
def draw_sweep(
    lines: Sequence[Line], settings: Sequence[Setting], x: Sequence[float], x_label: str, title: str
) -> Figure:
    """Six panels: rotation, translation, model; absolute and relative to EPnP."""
    methods = by_method(lines, settings)
    figure = new_figure(5.6)
    panels = figure.subplots(2, 3, sharex=True, height_ratios=(1.25, 1.0))
    for (name, label), above, below in zip(PANELS, *panels, strict=True):
        _absolute(above, methods, x, name)
        _relative(below, methods, x, name, SHOWN)
        above.set_title(label)
        below.set_xlabel(x_label)
    panels[0, 0].set_ylabel("mean error")
    panels[1, 0].set_ylabel("error / error of EPnP [-]")
    figure.align_ylabels(panels[:, 0])
    legend(figure, [name for name in (*SHOWN, "bound") if name in methods], title)
    return figure


@styled
def draw_sensitivity(
    lines: Sequence[Line], settings: Sequence[Setting], x: Sequence[float], x_label: str, title: str
) -> Figure:
    """Three panels: what the choices that the publication leaves open do to the window, in units of EPnP."""
    methods = by_method(lines, settings)
    figure = new_figure(3.3)
    panels = figure.subplots(1, 3, sharex=True)
    for (name, label), axes in zip(PANELS, panels, strict=True):
        _relative(axes, methods, x, name, SENSITIVITY, top=3.4)
        axes.set_title(label)
        axes.set_xlabel(x_label)
    panels[0].set_ylabel("error / error of EPnP [-]")
    legend(figure, [name for name in (*SENSITIVITY, "bound") if name in methods], title, ncols=3)
    return figure


def _absolute(axes: Axes, methods: ByMethod, x: Sequence[float], name: str) -> None:
    lowest: list[float] = []
    for method in SHOWN:
        if method in methods and not (name == "landmark_m" and method in NO_MODEL):
            draw_curve(axes, x, methods[method], error_of(name))
            lowest.append(min(line.statistics[name].mean for line in methods[method]))
    log_values(axes)
    if "bound" in methods:
        floor = [line.statistics[name].mean for line in methods["bound"]]
        bottom = 0.8 * min([*lowest, *floor])
        axes.fill_between(x, bottom, floor, color=LOOKS["bound"].colour, alpha=0.3, lw=0)
        axes.set_ylim(bottom, None)
    log_ticks(axes, x)


def _relative(
    axes: Axes, methods: ByMethod, x: Sequence[float], name: str, shown: Sequence[str], top: float = 1.62
) -> None:
    axes.axhline(1.0, color=LOOKS["epnp"].colour, lw=LOOKS["epnp"].width)
    for method in shown:
        if method in methods and method != "epnp" and not (name == "landmark_m" and method in NO_MODEL):
            draw_curve(axes, x, methods[method], ratio_of(name))
    if "bound" in methods and "epnp" in methods:
        floor = [
            b.statistics[name].mean / e.statistics[name].mean
            for b, e in zip(methods["bound"], methods["epnp"], strict=True)
        ]
        axes.fill_between(x, 0.0, floor, color=LOOKS["bound"].colour, alpha=0.3, lw=0)
    axes.set_ylim(0.0, top)
    log_ticks(axes, x)
    _mark_crossings(axes, methods, x, name, shown)


def _mark_crossings(axes: Axes, methods: ByMethod, x: Sequence[float], name: str, shown: Sequence[str]) -> None:
    """A ring where a window becomes worse, or better, than EPnP for good, with the place beside it."""
    for method in shown:
        if method not in methods or not method.startswith(("window", "free")):
            continue
        place = crossing(x, [line.against["epnp", name].ratio for line in methods[method]])
        if place is None:
            continue
        axes.plot([place], [1.0], marker="o", ms=6.0, mfc="white", mec=LOOKS[method].colour, mew=1.4, zorder=5)
        axes.annotate(
            f"{place:.2g}", (place, 1.0), xytext=(-3, 6), textcoords="offset points", ha="right", fontsize=8, color=INK
        )
