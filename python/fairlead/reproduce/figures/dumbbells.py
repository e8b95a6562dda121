# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Every landmark of the model before and after."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fairlead.evaluate.figures.style import GRID, MUTED, WIDTH_INCHES, styled
from fairlead.reproduce.figures.look import LOOKS
from fairlead.reproduce.methods import BATCH, EPNP, LABELS


@styled
def draw_dumbbells(names: Sequence[str], panels: Mapping[str, Mapping[str, np.ndarray]]) -> Figure:
    """A panel per sequence: method -> error of each landmark [m]; EPnP's is the told model."""
    figure = Figure(figsize=(WIDTH_INCHES, 0.155 * len(names) + 1.1), layout="constrained")
    axes_of = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
    y = np.arange(len(names))[::-1]
    for axes, (title, errors) in zip(axes_of, panels.items(), strict=True):
        stacked = np.array(list(errors.values()))
        axes.hlines(y, stacked.min(axis=0), stacked.max(axis=0), color=GRID, lw=1.4, zorder=1)
        for method, values in errors.items():
            hollow = method == EPNP
            colour = LOOKS[method].colour
            axes.scatter(
                values, y, s=_area(method), facecolors="none" if hollow else colour, edgecolors=colour, lw=1.1, zorder=2
            )
        axes.set_title(title)
        axes.set_xlabel("error [m]")
        axes.set_xlim(0.0, None)
        axes.tick_params(axis="y", length=0, labelsize=7.5, labelcolor=MUTED)
        axes.grid(visible=False, axis="y")
    axes_of[0].set_yticks(y, list(names))
    _legend(figure, list(next(iter(panels.values()))))
    return figure


def _area(method: str) -> float:
    """Small where it would hide the other of ours."""
    return 6.0 if method == BATCH else 19.0


def _legend(figure: Figure, methods: Sequence[str]) -> None:
    """Dots as they are drawn."""
    handles: list[Line2D] = []
    for method in methods:
        colour, told = LOOKS[method].colour, method == EPNP
        face = "none" if told else colour
        label = "told model" if told else LABELS[method]
        handles.append(Line2D([], [], ls="", marker="o", ms=_area(method) ** 0.5, mec=colour, mfc=face, label=label))
    figure.legend(handles=handles, loc="outside upper left", ncols=len(handles), columnspacing=1.4)
