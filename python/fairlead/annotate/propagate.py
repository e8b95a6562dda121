# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Marks of one frame carried to the next: by optical flow, started where the solved pose says.

docs/your-own-target.md section 2.
"""

from collections.abc import Mapping

import numpy as np

from fairlead.annotate.labels import Labels, Mark, Marks
from fairlead.annotate.solve import MIN_MARKS, FrameSolution, solve_frame, view_of
from fairlead.annotate.surface import Surface
from fairlead.opencv import GreyImage, carry_points
from fairlead.types import Camera

FLOW_SIGMA_PX = 1.5
"""Of a mark that flow has carried: a click's, and the drift of one step [px]."""

Expected = Mapping[int, tuple[float, float]]
"""Where landmarks are thought to be [px], by number."""


def carry_marks(
    marks: Marks, present: Marks, before: GreyImage, after: GreyImage, shifts: Expected | None = None
) -> dict[int, Mark]:
    """The marks of the next frame: what a person said there stays, the others are carried.

    Parameters
    ----------
    marks : of the frame before
    present : of the next frame; clicks and hidden ones are kept, marks carried earlier are replaced
    before, after : the two images
    shifts : how far the pose says that each landmark moves [px]

    A mark that flow loses is left out; one that is hidden stays hidden.
    """
    kept = {n: mark for n, mark in present.items() if mark.hidden or mark.origin == "click"}
    hidden = {n: mark for n, mark in marks.items() if mark.hidden and n not in kept}
    moving = [n for n, mark in marks.items() if not mark.hidden and n not in kept]
    pixels = np.array([(marks[n].u_px, marks[n].v_px) for n in moving], dtype=np.float64).reshape(-1, 2)
    shift = np.array([(shifts or {}).get(n, (0.0, 0.0)) for n in moving], dtype=np.float64).reshape(-1, 2)
    carried, followed = carry_points(before, after, pixels, pixels + shift)
    found = {
        n: Mark(u_px=float(u), v_px=float(v), sigma_px=max(FLOW_SIGMA_PX, marks[n].sigma_px), origin="flow")
        for n, (u, v), ok in zip(moving, carried, followed, strict=True)
        if ok
    }
    return {**kept, **hidden, **found}


def without_outliers(
    labels: Labels, frame: int, marks: Marks, camera: Camera, surface: Surface | None
) -> tuple[dict[int, Mark], FrameSolution | None]:
    """Take out carried marks that the pose contradicts, the worst first; clicks are left to the person.

    Returns the marks and the pose; None where there are too few marks for one.
    """
    left = dict(marks)
    while True:
        changed = Labels(landmarks=labels.landmarks, frames={frame: left})
        view = view_of(changed, frame, 0)
        if len(view.landmarks) < MIN_MARKS:
            return left, None
        solved = solve_frame(changed, view, camera, surface)
        warned = {each.number for each in solved.warnings if each.number is not None}
        wrong = {n for n in warned if left[n].origin == "flow"}
        if not wrong:
            return left, solved
        del left[max(wrong, key=lambda n: float(np.hypot(*solved.residuals.get(n, (np.inf, 0.0)))))]


def expected_shifts(earlier: FrameSolution | None, latest: FrameSolution | None) -> Expected:
    """How far each landmark moves in one more step like the last one [px]."""
    if earlier is None or latest is None:
        return {}
    return {
        n: (latest.projected[n][0] - earlier.projected[n][0], latest.projected[n][1] - earlier.projected[n][1])
        for n in latest.projected.keys() & earlier.projected.keys()
    }
