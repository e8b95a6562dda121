# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Normalised residuals against the distributions that they should have."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from scipy.stats import chi2, norm

from fairlead.evaluate.evaluation import Evaluation
from fairlead.evaluate.figures.style import COLOURS, colour_of, legend_above, new_figure, plain_decades, styled

_NORMAL_LIMIT = 5.0
_SQUARE_LIMIT = 16.0


@styled
def residuals(evaluations: Mapping[str, Evaluation]) -> Figure | None:
    """Components against the standard normal; squares against chi-square with 2 dof, as shares beyond a value."""
    known = {name: each.reprojection for name, each in evaluations.items() if each.reprojection is not None}
    if not known:
        return None
    figure = new_figure(2.9)
    left, right = figure.subplots(1, 2)
    bins = np.linspace(-_NORMAL_LIMIT, _NORMAL_LIMIT, 51)
    grid = np.linspace(0.0, _SQUARE_LIMIT, 200)
    for name, found in known.items():
        colour = colour_of(name, list(evaluations))
        components = np.clip(found.normalised.ravel(), bins[0], bins[-1])
        density, _ = np.histogram(components, bins=bins)
        left.stairs(density / (components.size * (bins[1] - bins[0])), bins, color=colour, linewidth=1.3, label=name)
        squares = np.sort(np.sum(found.normalised**2, axis=1))
        beyond = 1.0 - np.searchsorted(squares, grid, side="right") / squares.size
        right.plot(grid, np.where(beyond > 0.0, beyond, np.nan), color=colour)
    x = np.linspace(-_NORMAL_LIMIT, _NORMAL_LIMIT, 200)
    style = {"color": COLOURS["truth"], "linewidth": 1.0, "linestyle": (0, (3, 2))}
    left.plot(x, norm.pdf(x), label="expected", **style)
    right.plot(grid, chi2.sf(grid, 2), **style)
    left.set_xlabel("normalised residual [-], ends gather the rest")
    left.set_ylabel("density [-]")
    left.set_ylim(bottom=0.0)
    right.set_yscale("log")
    plain_decades(right.yaxis)
    right.set_ylim(1e-4, 1.3)
    right.set_xlim(0.0, _SQUARE_LIMIT)
    right.set_xlabel("squared normalised residual d² [-]")
    right.set_ylabel("share beyond [-]")
    legend_above(figure, left)
    return figure
