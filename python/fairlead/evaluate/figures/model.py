# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The landmark model: each landmark before and after, and the error while it was refined."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fairlead.evaluate.alignment import Alignment
from fairlead.evaluate.evaluation import Evaluation
from fairlead.evaluate.figures.style import GRID, MUTED, colour_of, legend_above, log_if_wide, new_figure, styled
from fairlead.evaluate.landmarks import LandmarkErrors, coordinate_sigmas
from fairlead.evaluate.summary import Series
from fairlead.evaluate.units import length_unit

MAX_LANDMARKS = 60
"""More are not legible: the largest are drawn."""

Lengths = Mapping[str, float]
"""Landmark -> length, in the unit of the figure."""

_ALIGNED: dict[Alignment, str] = {
    "raw": "as it is",
    "se3": "after rigid alignment",
    "sim3": "after similarity alignment",
}


_KINDS: dict[str, dict[str, Any]] = {
    "raw": {},
    "promised": {"linewidth": 0.9, "linestyle": (0, (4, 3))},
    "without gauge and scale": {"alpha": 0.45},
}


@styled
def landmarks_before_and_after(evaluations: Mapping[str, Evaluation], alignment: Alignment) -> Figure | None:
    """One line per landmark, from its error in the given model to that in the refined one. None without truth."""
    after = {name: errors for name, each in evaluations.items() if (errors := _after(each, alignment)) is not None}
    before = next((errors for each in evaluations.values() if (errors := _before(each, alignment)) is not None), None)
    if not after or before is None:
        return None
    unit = length_unit(evaluations.values())
    start = _lengths(before, unit.per_metre)
    ends = {name: _lengths(errors, unit.per_metre) for name, errors in after.items()}
    figure, axes = _dots(start, "before", ends, list(evaluations))
    axes.set_xlabel(f"distance from the true landmark, {_ALIGNED[alignment]} [{unit.name}]")
    return figure


@styled
def landmark_shifts(evaluations: Mapping[str, Evaluation]) -> Figure | None:
    """How far each landmark went, beside the sigma that the given model claimed. None where no model was refined."""
    moved = {name: each for name, each in evaluations.items() if _is_refined(each)}
    if not moved:
        return None
    unit = length_unit(evaluations.values())
    given = next(iter(moved.values())).run.target0
    told = unit.per_metre * np.sqrt(np.sum(coordinate_sigmas(given) ** 2, axis=1))
    ends: dict[str, Lengths] = {}
    for name, each in moved.items():
        assert each.model_change is not None
        shifts = (unit.per_metre * each.model_change.shifts_m).tolist()
        ends[name] = dict(zip(each.model_change.names, shifts, strict=True))
    start = dict(zip(given.landmarks, told.tolist(), strict=True))
    order = {name: max(end.get(name, 0.0) for end in ends.values()) for name in start}
    figure, axes = _dots(start, "1 sigma, as told", ends, list(evaluations), order)
    axes.set_xlabel(f"distance between given and refined landmark [{unit.name}]")
    return figure


def _dots(
    start: Lengths, label: str, ends: Mapping[str, Lengths], methods: Sequence[str], order_by: Lengths | None = None
) -> tuple[Figure, Axes]:
    """A row per landmark: a ring at the start, a dot per method at its end, the largest on top."""
    key = start if order_by is None else order_by
    order = sorted(start, key=lambda name: key[name])[-MAX_LANDMARKS:]
    figure = new_figure(1.0 + 0.17 * len(order))
    axes = figure.subplots()
    rows = np.arange(len(order))
    for row, landmark in enumerate(order):
        reached = [start[landmark], *(end[landmark] for end in ends.values() if landmark in end)]
        axes.plot([min(reached), max(reached)], [row, row], color=GRID, linewidth=1.6, zorder=1)
    rings = [start[name] for name in order]
    axes.scatter(rings, rows, s=22, facecolors="none", edgecolors=MUTED, label=label, zorder=2)
    for name, end in ends.items():
        values = [end.get(landmark, np.nan) for landmark in order]
        axes.scatter(values, rows, s=18, color=colour_of(name, methods), label=name, zorder=3)
    axes.set_yticks(rows, order, fontsize=8.0)
    axes.set_ylim(-0.7, len(order) - 0.3)
    lengths = [rings, *([end.get(landmark, np.nan) for landmark in order] for end in ends.values())]
    log_if_wide(axes, [np.array(each, dtype=np.float64) for each in lengths], "x")
    axes.grid(visible=False, axis="y")
    legend_above(figure, axes)
    return figure, axes


def _lengths(errors: LandmarkErrors, per_metre: float) -> Lengths:
    return dict(zip(errors.names, (per_metre * errors.errors_m).tolist(), strict=True))


def _is_refined(evaluation: Evaluation) -> bool:
    """False for a method that leaves the model as it was given."""
    return evaluation.model_change is not None and evaluation.model_change.summary.maximum > 0.0


def _after(evaluation: Evaluation, alignment: Alignment) -> LandmarkErrors | None:
    if evaluation.model_after is None or not _is_refined(evaluation):
        return None
    return evaluation.model_after.aligned(alignment)


def _before(evaluation: Evaluation, alignment: Alignment) -> LandmarkErrors | None:
    return None if evaluation.model_before is None else evaluation.model_before.aligned(alignment)


@styled
def model_over_time(evaluations: Mapping[str, Evaluation]) -> Figure | None:
    """Rms landmark error raw and without gauge, with what the covariance promises. None without a history."""
    known = {
        name: each.model_history
        for name, each in evaluations.items()
        if each.model_history is not None and _is_refined(each)
    }
    if not known:
        return None
    unit = length_unit(evaluations.values())
    figure = new_figure(2.8)
    axes = figure.subplots()
    drawn: list[Series] = []
    for name, history in known.items():
        colour = colour_of(name, list(evaluations))
        seconds = np.append(history.seconds, max(float(evaluations[name].run.seconds[-1]), float(history.seconds[-1])))
        for values, style in zip((history.raw_m, history.sigma_m, history.sim3_m), _KINDS.values(), strict=True):
            drawn.append(unit.per_metre * np.append(values, values[-1]))
            axes.step(seconds, drawn[-1], where="post", color=colour, **style)
        axes.plot([], [], color=colour, label=name)
    for label, style in _KINDS.items():
        axes.plot([], [], color=MUTED, label=label, **style)
    log_if_wide(axes, drawn)
    axes.set_ylabel(f"landmark error rms [{unit.name}]")
    axes.set_xlabel("time [s]")
    axes.margins(x=0.01)
    legend_above(figure, axes)
    return figure
