# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The camera's path in the target frame, with the landmarks."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from jaxtyping import Float64
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from fairlead.evaluate.evaluation import Evaluation
from fairlead.evaluate.figures.style import COLOURS, GRID, INK, MUTED, colour_of, legend_above, new_figure, styled
from fairlead.evaluate.pose import camera_positions
from fairlead.evaluate.units import length_unit

Path3 = Float64[np.ndarray, "_ 3"]
"""Positions in the unit of the figure; each path has a length of its own."""

MAX_STEPS = 400
"""Points of a path: more cannot be seen."""


@styled
def trajectory(evaluations: Mapping[str, Evaluation]) -> Figure | None:
    """A view in space, one from above and one from the side, target axes. None where there are no poses."""
    unit = length_unit(evaluations.values())
    paths = {
        name: unit.per_metre * _path(camera_positions(each.run.T_camera_target)) for name, each in evaluations.items()
    }
    paths = {name: path for name, path in paths.items() if np.isfinite(path).any()}
    true = _true_path(evaluations, unit.per_metre)
    if not paths:
        return None
    landmarks = unit.per_metre * _landmarks(next(iter(evaluations.values())))
    anchor = true if true is not None else np.concatenate(list(paths.values()))
    low, high = _box(np.concatenate([anchor, landmarks]), trim=true is None)
    figure = new_figure(4.3)
    extent = np.maximum(high - low, 0.3 * float((high - low).max()))
    grid = figure.add_gridspec(2, 2, width_ratios=[1.35, 1.0], height_ratios=[extent[1], extent[2]])
    space: Any = figure.add_subplot(grid[:, 0], projection="3d")
    above = figure.add_subplot(grid[0, 1])
    side = figure.add_subplot(grid[1, 1])
    clipped = {name: _inside(path, low, high) for name, path in paths.items()}
    for panel, axes in ((space, (0, 1, 2)), (above, (0, 1)), (side, (0, 2))):
        _draw(panel, axes, landmarks, true, clipped, list(evaluations))
    _finish_space(space, low, high, unit.name)
    for panel, vertical in ((above, 1), (side, 2)):
        panel.set_xlim(low[0], high[0])
        panel.set_ylim(low[vertical], high[vertical])
        panel.set_aspect("equal", adjustable="box", anchor="W")
        panel.set_xlabel(f"x [{unit.name}]")
        panel.locator_params(axis="y", nbins=5)
        panel.set_ylabel(f"{'xyz'[vertical]} [{unit.name}]")
    legend_above(figure, above)
    return figure


def _path(positions: Path3) -> Path3:
    return positions[:: -(-len(positions) // MAX_STEPS) or 1]


def _true_path(evaluations: Mapping[str, Evaluation], per_metre: float) -> Path3 | None:
    """Of the method that was judged on most frames."""
    judged = [each.truth.T_true for each in evaluations.values() if each.truth is not None]
    longest = max(judged, key=len, default=None)
    return None if longest is None or not len(longest) else per_metre * _path(camera_positions(longest))


def _landmarks(evaluation: Evaluation) -> Path3:
    run = evaluation.run
    return (run.target_true or run.target_estimated or run.target0).positions


def _box(points: Path3, *, trim: bool) -> tuple[np.ndarray, np.ndarray]:
    """Limits of the axes, padded; without truth a few wild poses do not set them."""
    present = points[np.isfinite(points).all(axis=1)]
    low, high = (
        (np.quantile(present, 0.02, axis=0), np.quantile(present, 0.98, axis=0))
        if trim
        else (present.min(axis=0), present.max(axis=0))
    )
    pad = 0.08 * float((high - low).max())
    return low - pad, high + pad


def _inside(path: Path3, low: np.ndarray, high: np.ndarray) -> Path3:
    """NaN where the path leaves the box: the view in space does not clip."""
    outside = np.logical_or(path < low, path > high).any(axis=1)
    clipped = path.copy()
    clipped[outside] = np.nan
    return clipped


def _draw(
    panel: Any,
    axes: tuple[int, ...],
    landmarks: Path3,
    true: Path3 | None,
    paths: Mapping[str, Path3],
    names: list[str],
) -> None:
    def columns(points: Path3) -> list[np.ndarray]:
        return [points[:, axis] for axis in axes]

    panel.scatter(*columns(landmarks), s=5, color=MUTED, linewidths=0.0, label="landmarks")
    for name, path in paths.items():
        dots = {"marker": "o", "markersize": 3.0 if len(path) <= 60 else 2.0, "markeredgewidth": 0.0}
        panel.plot(*columns(path), color=colour_of(name, names), linestyle="none", alpha=0.8, label=name, **dots)
    if true is not None:
        panel.plot(*columns(true), color=COLOURS["truth"], linewidth=1.0, linestyle=(0, (3, 2)), label="truth")


def _finish_space(space: Any, low: np.ndarray, high: np.ndarray, unit: str) -> None:
    space.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    extent = (high - low) / float((high - low).max())
    space.set_box_aspect(np.maximum(extent, 0.15), zoom=1.0 - 0.14 * extent[2])  # tall boxes need room for their labels
    space.set(xlabel=f"x [{unit}]", ylabel=f"y [{unit}]", zlabel=f"z [{unit}]")
    space.view_init(elev=24, azim=-58)
    for axis, share in zip((space.xaxis, space.yaxis, space.zaxis), extent, strict=True):
        axis.set_major_locator(MaxNLocator(nbins=max(2, round(5 * share))))
        axis.set_pane_color((0.0, 0.0, 0.0, 0.0))
        axis.line.set_color(MUTED)
        axis._axinfo["grid"].update(color=GRID, linewidth=0.6)  # noqa: SLF001  (matplotlib has no other way)
        axis.label.set_color(INK)
    space.zaxis.labelpad = -3.0
    space.tick_params(labelsize=7.5, pad=0.0)
