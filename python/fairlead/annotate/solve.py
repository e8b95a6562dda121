# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Poses of labelled frames, by the batch of the estimator: one frame at a time, or all jointly.

docs/your-own-target.md section 3.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fairlead.annotate.labels import Labels, Mark
from fairlead.annotate.surface import Surface
from fairlead.cameras import project
from fairlead.geometry import inverse, transform
from fairlead.tracker import Refinement, refine
from fairlead.types import Camera, Estimate, Matrix4, Pixels, Target, View, no_pose

MIN_MARKS = 4
"""Fewer do not determine a pose."""
BAD_CLICK = 13.8
"""Squared whitened residual [-] beyond which a click is called bad: one good click in a thousand."""
SWAPPED = 9.2
"""A bad click whose squared whitened distance to another landmark is below this is taken for that one [-]."""

_REASONS = {
    "too_few": f"fewer than {MIN_MARKS} landmarks are marked",
    "degenerate": "the marked landmarks do not determine a pose: mark some that lie elsewhere",
    "gated": "no pose explains enough of the marks: one or more are on the wrong landmark",
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Warned:
    """What is odd about a frame, or about one mark in it."""

    number: int | None
    """Of the landmark; None: the frame as a whole."""
    text: str


@dataclass(frozen=True, kw_only=True, eq=False)
class FrameSolution:
    """Pose of one frame, and what it says of the marks."""

    estimate: Estimate
    projected: Mapping[int, tuple[float, float]]
    """Where each landmark should be [px], by number; those behind the camera are missing. Empty without a pose."""
    residuals: Mapping[int, tuple[float, float]]
    """Projection minus mark [px]."""
    in_sight: frozenset[int]
    """Landmarks in the image that the mesh does not hide."""
    warnings: tuple[Warned, ...]


def target_of(labels: Labels, name: str, mesh: Path | None = None) -> Target:
    """The landmarks as a prior: independent errors of their sigmas. Raises ValueError without landmarks."""
    if not labels.landmarks:
        raise ValueError("expected landmarks, got none")
    return Target(
        name=name,
        landmarks=tuple(each.name for each in labels.landmarks),
        positions=labels.positions,
        covariance=np.diag(labels.sigmas.ravel() ** 2),
        mesh=mesh,
    )


def view_of(labels: Labels, frame: int, stamp_ns: int) -> View:
    """The marks of a frame as observations; hidden ones are none."""
    marks = labels.marks(frame)
    seen = [(each.name, marks[each.number]) for each in labels.landmarks if each.number in marks]
    seen = [(name, mark) for name, mark in seen if not mark.hidden]
    return View(
        frame=frame,
        stamp_ns=stamp_ns,
        landmarks=tuple(name for name, _ in seen),
        pixels=np.array([(mark.u_px, mark.v_px) for _, mark in seen]).reshape(-1, 2),
        covariances=np.array([mark.sigma_px**2 * np.eye(2) for _, mark in seen]).reshape(-1, 2, 2),
    )


def solve_frame(labels: Labels, view: View, camera: Camera, surface: Surface | None = None) -> FrameSolution:
    """Pose of one frame from its marks alone, by `fairlead.tracker.refine` on this one view.

    The landmarks' sigmas count: their covariance is part of that of the pose.
    """
    if len(view.landmarks) < MIN_MARKS:
        few = f"{len(view.landmarks)} of at least {MIN_MARKS} landmarks marked"
        return FrameSolution(
            estimate=no_pose(view, "lost", "too_few"),
            projected={},
            residuals={},
            in_sight=frozenset(),
            warnings=(Warned(number=None, text=few),) if view.landmarks else (),
        )
    solved = refine([view], target_of(labels, "target"), camera)
    return explain(labels, view, solved.estimates[0], solved.model, camera, surface)


@dataclass(frozen=True, kw_only=True, eq=False)
class JointSolution:
    """All frames in one: poses, and the landmarks that the frames agree on."""

    refinement: Refinement
    solutions: Mapping[int, FrameSolution]
    """By frame; only those with enough marks."""
    revision: int
    """Of the document that was solved."""


def solve_jointly(
    labels: Labels, views: Sequence[View], camera: Camera, surface: Surface | None = None, revision: int = 0
) -> JointSolution:
    """One posterior over the landmarks and the poses of all frames with enough marks, docs/estimator.md section 5.

    Raises ValueError where no frame has enough marks, or there are no landmarks.
    """
    usable = [view for view in views if len(view.landmarks) >= MIN_MARKS]
    if not usable:
        raise ValueError(f"expected a frame with at least {MIN_MARKS} landmarks marked, got none")
    solved = refine(usable, target_of(labels, "target"), camera)
    solutions = {
        view.frame: explain(labels, view, estimate, solved.model, camera, surface)
        for view, estimate in zip(usable, solved.estimates, strict=True)
    }
    return JointSolution(refinement=solved, solutions=solutions, revision=revision)


def explain(
    labels: Labels, view: View, estimate: Estimate, model: Target, camera: Camera, surface: Surface | None
) -> FrameSolution:
    """What a pose with its model says of the marks of its frame."""
    if not estimate.ok:
        reason = _REASONS.get(estimate.reason, f"no pose: {estimate.reason or estimate.status}")
        warned = (Warned(number=None, text=reason),)
        return FrameSolution(estimate=estimate, projected={}, residuals={}, in_sight=frozenset(), warnings=warned)
    T = estimate.T_camera_target
    pixels = project(camera, transform(T, model.positions))
    numbers = [each.number for each in labels.landmarks]
    projected = {n: (float(u), float(v)) for n, (u, v) in zip(numbers, pixels, strict=True) if np.isfinite(u)}
    marks = {n: mark for n, mark in labels.marks(view.frame).items() if not mark.hidden}
    residuals = {n: (projected[n][0] - m.u_px, projected[n][1] - m.v_px) for n, m in marks.items() if n in projected}
    in_sight = _in_sight(labels, T, pixels, camera, surface)
    warnings = _bad_clicks(labels, marks, projected, residuals)
    for number in marks.keys() - in_sight:
        name = labels.landmark(number).name
        text = f"{name} is marked, but the mesh hides it from here" if number in projected else f"{name} is behind"
        warnings.append(Warned(number=number, text=text))
    return FrameSolution(
        estimate=estimate, projected=projected, residuals=residuals, in_sight=in_sight, warnings=tuple(warnings)
    )


def _in_sight(
    labels: Labels, T_camera_target: Matrix4, pixels: Pixels, camera: Camera, surface: Surface | None
) -> frozenset[int]:
    with np.errstate(invalid="ignore"):
        inside = ((pixels >= -0.5) & (pixels <= np.array([camera.width, camera.height]) - 0.5)).all(axis=1)
    if surface is not None:
        X = labels.positions
        inside &= surface.seen_from(inverse(T_camera_target)[:3, 3], X, 1.1 * surface.distance_m(X))
    return frozenset(labels.landmarks[row].number for row in np.flatnonzero(inside))


def _bad_clicks(
    labels: Labels,
    marks: Mapping[int, Mark],
    projected: Mapping[int, tuple[float, float]],
    residuals: Mapping[int, tuple[float, float]],
) -> list[Warned]:
    warnings: list[Warned] = []
    for number, (du, dv) in residuals.items():
        mark = marks[number]
        if (du * du + dv * dv) / mark.sigma_px**2 <= BAD_CLICK:
            continue
        name = labels.landmark(number).name
        text = f"{name} is {np.hypot(du, dv):.1f} px off"
        others = {n: np.hypot(u - mark.u_px, v - mark.v_px) for n, (u, v) in projected.items() if n != number}
        nearest = min(others, key=others.__getitem__, default=None)
        if nearest is not None and others[nearest] ** 2 <= SWAPPED * max(mark.sigma_px, 1.0) ** 2:
            text += f": is it {labels.landmark(nearest).name}?"
        warnings.append(Warned(number=number, text=text))
    return warnings


def in_order(estimates: Sequence[Estimate]) -> list[Estimate]:
    """By the number of the frame, as truth.csv has them."""
    return [replace(each) for each in sorted(estimates, key=lambda each: each.frame)]
