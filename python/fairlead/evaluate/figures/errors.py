# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Errors over time: rotation, translation, camera position of every method; reprojection where there is no truth."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fairlead.evaluate.evaluation import AgainstTruth, Evaluation
from fairlead.evaluate.figures.curves import draw_curve, spans
from fairlead.evaluate.figures.style import MUTED, colour_of, legend_above, log_if_wide, new_figure, styled
from fairlead.evaluate.summary import Series

Curve = tuple[Series, Series]
"""Seconds and values."""


@styled
def errors_over_time(evaluations: Mapping[str, Evaluation]) -> Figure | None:
    """Three panels against time, and a strip that shows where a method failed. None where nothing was judged."""
    judged = {name: each.truth for name, each in evaluations.items() if each.truth and each.truth.rows.size}
    if not judged:
        return None
    failing = [name for name, truth in judged.items() if truth.raw.failed.any()]
    strip = 0.12 + 0.12 * len(failing) if failing else 0.0
    figure = new_figure(5.4 + strip)
    ratios = [1.0, 1.0, 1.0] + ([strip] if failing else [])
    panels = figure.subplots(len(ratios), 1, sharex=True, gridspec_kw={"height_ratios": ratios}, squeeze=False)[:, 0]
    for axes, (label, pick) in zip(panels, _QUANTITIES, strict=False):
        curves = {name: (_seconds(evaluations[name], truth), pick(truth)) for name, truth in judged.items()}
        _draw(axes, curves, list(evaluations))
        axes.set_ylabel(label)
    if failing:
        _draw_failures(panels[3], {name: judged[name] for name in failing}, evaluations)
    panels[-1].set_xlabel("time [s]")
    figure.align_ylabels(list(panels[:3]))
    legend_above(figure, panels[0])
    return figure


@styled
def reprojection_over_time(evaluations: Mapping[str, Evaluation]) -> Figure | None:
    """Rms of each frame [px]. None without observations."""
    curves = {
        name: (each.run.seconds, each.reprojection.per_frame_px)
        for name, each in evaluations.items()
        if each.reprojection is not None
    }
    if not curves:
        return None
    figure = new_figure(2.4)
    axes = figure.subplots()
    _draw(axes, curves, list(evaluations))
    axes.set_ylabel("reprojection rms [px]")
    axes.set_xlabel("time [s]")
    legend_above(figure, axes)
    return figure


def _rotation(truth: AgainstTruth) -> Series:
    return truth.raw.rotation_deg.values


def _translation(truth: AgainstTruth) -> Series:
    return truth.raw.translation_percent.values


def _position(truth: AgainstTruth) -> Series:
    return truth.raw.position_percent.values


_QUANTITIES = (
    ("rotation [deg]", _rotation),
    ("translation\n[% of range]", _translation),
    ("camera position\n[% of range]", _position),
)


def _seconds(evaluation: Evaluation, truth: AgainstTruth) -> Series:
    return evaluation.run.seconds[truth.rows]


def _draw(axes: Axes, curves: Mapping[str, Curve], names: Sequence[str]) -> None:
    for name, (seconds, values) in curves.items():
        draw_curve(axes, seconds, values, colour_of(name, names), label=name)
    log_if_wide(axes, [values for _, values in curves.values()])
    axes.margins(x=0.01)


def _draw_failures(axes: Axes, judged: Mapping[str, AgainstTruth], evaluations: Mapping[str, Evaluation]) -> None:
    """A bar where frames failed: tall and coloured where a wrong pose was given, low and grey where none was."""
    names = list(evaluations)
    for row, (name, truth) in enumerate(judged.items()):
        seconds = _seconds(evaluations[name], truth)
        silent = np.isnan(truth.raw.rotation_deg.values)
        kinds = ((truth.raw.failed & ~silent, 0.7, colour_of(name, names)), (silent, 0.3, MUTED))
        for flags, height, colour in kinds:
            bars = spans(seconds, flags)
            axes.broken_barh(bars, (-row - 0.5 * height, height), facecolor=colour, linewidth=0.0)
    axes.set_ylim(-len(judged) + 0.4, 0.6)
    axes.set_yticks([-row for row in range(len(judged))], [f"{name}: failed" for name in judged], fontsize=8.0)
    axes.grid(visible=False)
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0.0)
