# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Errors of single photographs."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from fairlead.evaluate.figures.style import new_figure, styled
from fairlead.reproduce.figures.look import LOOKS, legend
from fairlead.reproduce.photographs import TempleErrors
from fairlead.study.figures.look import log_values


@styled
def draw_camera_errors(errors: Mapping[str, TempleErrors]) -> Figure:
    """A line per method."""
    figure = new_figure(2.9)
    axes = figure.subplots()
    count = max(len(each.positions_percent) for each in errors.values())
    place = np.arange(1, count + 1)
    for method, each in errors.items():
        look = LOOKS[method]
        axes.plot(place, each.positions_percent, color=look.colour, lw=look.width, marker="o", ms=3.4)
    log_values(axes)
    axes.set_xlabel("photograph")
    axes.set_ylabel("camera position [% of range]")
    axes.set_xticks(place)
    legend(figure, tuple(errors))
    return figure
