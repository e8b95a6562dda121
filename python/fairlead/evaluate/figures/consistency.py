# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Signed errors inside the 3-sigma that the covariance promises, and NEES over time."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fairlead.evaluate.consistency import Nees, chi_square_band
from fairlead.evaluate.evaluation import Evaluation
from fairlead.evaluate.figures.curves import binned, draw_curve, is_long
from fairlead.evaluate.figures.style import MUTED, colour_of, new_figure, plain_decades, styled
from fairlead.evaluate.summary import Series, quantile
from fairlead.evaluate.units import length_unit

_BINS = 80
"""Parts of a long run in a narrow panel."""

_AXES = ("x", "y", "z")


@styled
def consistency(evaluation: Evaluation, name: str) -> Figure | None:
    """The six components of xi (target axes) with +-3 sigma, NEES / dof below. None without errors or covariance."""
    truth = evaluation.truth
    if truth is None or truth.consistency.nees is None:
        return None
    found = truth.consistency
    seconds = evaluation.run.seconds[truth.rows]
    figure = new_figure(5.4)
    grid = figure.add_gridspec(3, 3, height_ratios=[1.0, 1.0, 0.9])
    colour = colour_of(name, [name])
    first: Axes | None = None
    unit = length_unit([evaluation])
    components = [
        *((f"along {axis} [{unit.name}]", unit.per_metre) for axis in _AXES),
        *((f"about {axis} [deg]", float(np.degrees(1.0))) for axis in _AXES),
    ]
    for k, (label, factor) in enumerate(components):
        axes = figure.add_subplot(grid[k // 3, k % 3], sharex=first)
        first = first or axes
        _component(axes, seconds, factor * found.xi[:, k], factor * found.sigma[:, k], colour)
        axes.set_title(label, fontweight="normal")
        axes.tick_params(labelbottom=False)
    _nees_panel(figure.add_subplot(grid[2, :], sharex=first), seconds, truth.consistency.nees, colour)
    return figure


def _component(axes: Axes, seconds: Series, error: Series, sigma: Series, colour: str) -> None:
    t, s = seconds, 3.0 * sigma
    if is_long(len(error)):
        bins = binned(seconds, s, share=0.0, count=_BINS)
        t, s = bins.seconds, bins.middle
    axes.fill_between(t, -s, s, color=colour, alpha=0.13, linewidth=0.0)
    for sign in (-1.0, 1.0):
        axes.plot(t, sign * s, color=colour, linewidth=0.6, alpha=0.6)
    axes.axhline(0.0, color=MUTED, linewidth=0.6)
    draw_curve(axes, seconds, error, colour, share=1.0, count=_BINS)
    present = np.abs(np.concatenate([error[np.isfinite(error)], 3.0 * sigma[np.isfinite(sigma)]]))
    limit = quantile(present, 0.98) * 1.2 if present.size else 0.0
    if limit > 0.0:
        axes.set_ylim(-limit, limit)
    axes.margins(x=0.01)


def _nees_panel(axes: Axes, seconds: Series, nees: Nees, colour: str) -> None:
    dof = round(nees.dof / nees.n_samples)
    for probability, alpha in ((0.999, 0.08), (0.95, 0.14)):
        band = chi_square_band(dof, probability)
        axes.axhspan(band.lower, band.upper, color=MUTED, alpha=alpha, linewidth=0.0)
    axes.axhline(1.0, color=MUTED, linewidth=0.6)
    draw_curve(axes, seconds, nees.values, colour, share=1.0)
    axes.set_yscale("log")
    plain_decades(axes.yaxis)
    present = nees.values[np.isfinite(nees.values) & (nees.values > 0.0)]
    low, high = chi_square_band(dof, 0.999).lower, chi_square_band(dof, 0.999).upper
    axes.set_ylim(
        min(low * 0.7, float(np.quantile(present, 0.02))) if present.size else low,
        max(high * 1.5, float(present.max()) * 1.3) if present.size else high,
    )
    axes.set_ylabel("NEES / dof [-]")
    axes.set_xlabel("time [s]")
    axes.set_title("one pose: grey 95 % and 99.9 % band", fontweight="normal")
    axes.margins(x=0.01)
