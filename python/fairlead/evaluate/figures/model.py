# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The landmark model: each landmark before and after, and the error while it was refined."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from fairlead.evaluate.alignment import Alignment
from fairlead.evaluate.evaluation import Evaluation
from fairlead.evaluate.figures.style import GRID, MUTED, colour_of, legend_above, new_figure, styled
from fairlead.evaluate.landmarks import LandmarkErrors
from fairlead.evaluate.summary import Series

MAX_LANDMARKS = 60
"""More are not legible: the worst are drawn."""


@styled
def landmarks_before_and_after(evaluations: Mapping[str, Evaluation], alignment: Alignment) -> Figure | None:
    """One line per landmark, from its error in the given model to that in the refined one [m]."""
    after = {name: errors for name, each in evaluations.items() if (errors := _after(each, alignment)) is not None}
    before = next((errors for each in evaluations.values() if (errors := _before(each, alignment)) is not None), None)
    if not after or before is None:
        return None
    start = dict(zip(before.names, before.errors_m.tolist(), strict=True))
    order = sorted(start, key=lambda name: start[name])[-MAX_LANDMARKS:]
    figure = new_figure(1.0 + 0.17 * len(order))
    axes = figure.subplots()
    rows = np.arange(len(order))
    ends = [dict(zip(errors.names, errors.errors_m.tolist(), strict=True)) for errors in after.values()]
    for row, landmark in enumerate(order):
        reached = [start[landmark], *(end[landmark] for end in ends if landmark in end)]
        axes.plot([min(reached), max(reached)], [row, row], color=GRID, linewidth=1.6, zorder=1)
    axes.scatter(
        [start[name] for name in order], rows, s=22, facecolors="none", edgecolors=MUTED, label="before", zorder=2
    )
    for (name, _), end in zip(after.items(), ends, strict=True):
        values = [end.get(landmark, np.nan) for landmark in order]
        axes.scatter(values, rows, s=18, color=colour_of(name, list(evaluations)), label=name, zorder=3)
    axes.set_yticks(rows, order, fontsize=8.0)
    axes.set_ylim(-0.7, len(order) - 0.3)
    axes.set_xlim(left=0.0)
    axes.grid(visible=False, axis="y")
    axes.set_xlabel(f"distance from the true landmark, {_ALIGNED[alignment]} [m]")
    legend_above(figure, axes)
    return figure


_ALIGNED: dict[Alignment, str] = {
    "raw": "as it is",
    "se3": "after rigid alignment",
    "sim3": "after similarity alignment",
}


def _after(evaluation: Evaluation, alignment: Alignment) -> LandmarkErrors | None:
    """None for a method that leaves the model as it was given."""
    if evaluation.model_after is None or evaluation.model_change is None:
        return None
    if evaluation.model_change.summary.maximum == 0.0:
        return None
    return evaluation.model_after.aligned(alignment)


def _before(evaluation: Evaluation, alignment: Alignment) -> LandmarkErrors | None:
    return None if evaluation.model_before is None else evaluation.model_before.aligned(alignment)


@styled
def model_over_time(evaluations: Mapping[str, Evaluation]) -> Figure | None:
    """Rms landmark error raw and without gauge, with what the covariance says [m]. None without a history."""
    known = {name: each.model_history for name, each in evaluations.items() if each.model_history is not None}
    if not known:
        return None
    figure = new_figure(2.6)
    axes = figure.subplots()
    for name, history in known.items():
        colour = colour_of(name, list(evaluations))
        end = float(evaluations[name].run.seconds[-1])
        curves: tuple[tuple[Series, str, dict[str, Any]], ...] = (
            (history.raw_m, "raw", {}),
            (history.sigma_m, "promised", {"linewidth": 0.9, "linestyle": (0, (4, 3))}),
            (history.sim3_m, "without gauge and scale", {"alpha": 0.45}),
        )
        for values, label, style in curves:
            seconds = np.append(history.seconds, max(end, float(history.seconds[-1])))
            curve = np.append(values, values[-1])
            axes.step(seconds, curve, where="post", color=colour, label=f"{name}: {label}", **style)
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel("landmark error rms [m]")
    axes.set_xlabel("time [s]")
    axes.margins(x=0.01)
    legend_above(figure, axes)
    return figure
