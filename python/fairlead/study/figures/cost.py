# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What the methods cost, and whether their covariances are true."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullFormatter

from fairlead.evaluate.figures.style import COLOURS, new_figure, styled
from fairlead.study.figures.look import LOOKS, by_method, draw_curve, legend, log_ticks, log_values
from fairlead.study.figures.sweep import ByMethod, error_of
from fairlead.study.settings import Setting
from fairlead.study.summary import Line

_PANELS = (
    ("iterations", "iterations of the joint solve", ("window", "window-5", "window-3", "free", "map")),
    ("milliseconds", "processor time of a run [ms]", ("epnp", "single", "window", "window-5", "free", "online", "map")),
    ("pose_nees", "NEES of the poses / 6", ("epnp", "single", "window", "free", "true-model", "online", "map")),
    ("landmark_nees", "NEES of the model / 3n", ("online", "map")),
)


@styled
def draw_cost(
    lines: Sequence[Line], settings: Sequence[Setting], x: Sequence[float], x_label: str, title: str
) -> Figure:
    """Four panels: iterations, time, NEES of poses and of the model."""
    methods = by_method(lines, settings)
    figure = new_figure(5.6)
    panels = figure.subplots(2, 2)
    for (name, label, shown), axes in zip(_PANELS, panels.flat, strict=True):
        _draw(axes, methods, x, name, shown)
        axes.set_title(label)
    for axes in panels[1]:
        axes.set_xlabel(x_label)
    everywhere = {name for _, _, shown in _PANELS for name in shown}
    legend(figure, [name for name in LOOKS if name in everywhere & methods.keys()], title, ncols=3)
    return figure


def _draw(axes: Axes, methods: ByMethod, x: Sequence[float], name: str, shown: Sequence[str]) -> None:
    if name.endswith("nees"):
        axes.axhspan(0.8, 1.25, color=COLOURS["bound"], alpha=0.25, lw=0)
    for method in shown:
        if method in methods:
            draw_curve(axes, x, methods[method], error_of(name))
    log_values(axes)
    if name == "landmark_nees":
        axes.set_ylim(0.5, 2.0)
        axes.yaxis.set_minor_formatter(NullFormatter())
        axes.yaxis.set_major_locator(FixedLocator([0.5, 0.7, 1.0, 1.4, 2.0]))
    log_ticks(axes, x)
