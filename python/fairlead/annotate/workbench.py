# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What the page can do, without the page: poses kept in step with the labels, marks carried on, files saved."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from fairlead import opencv
from fairlead.annotate.document import Action, Document, MarksChange
from fairlead.annotate.export import Exported, export_all
from fairlead.annotate.labels import Labels, Triple, triple
from fairlead.annotate.project import Frame, Project
from fairlead.annotate.propagate import carry_marks, expected_shifts, without_outliers
from fairlead.annotate.solve import FrameSolution, JointSolution, solve_frame, solve_jointly, view_of
from fairlead.annotate.suggest import suggest_landmarks

SIGMA_SHARE = 0.005
"""Sigma of a landmark picked on the mesh, as a share of its size, until a person says better [-]."""
SNAP = 0.02
"""A pick within this share of the size from a corner of the mesh is meant to be the corner [-]."""


@dataclass(frozen=True, kw_only=True)
class Propagated:
    """What came of carrying the marks of a frame to the next."""

    frame: int
    """The next one."""
    carried: int
    lost: int

    def __str__(self) -> str:
        lost = f", {self.lost} lost" if self.lost else ""
        return f"frame {self.frame}: {self.carried} marks carried{lost}"


class Workbench:
    """A project with its poses."""

    def __init__(self, project: Project) -> None:
        self.project = project
        self.joint: JointSolution | None = None
        self._solutions: dict[int, FrameSolution] = {}
        self._grey = lru_cache(maxsize=4)(_read_grey)
        project.document.listen(self._forget)

    @property
    def document(self) -> Document:
        """The labels and what can be done to them."""
        return self.project.document

    @property
    def labels(self) -> Labels:
        """As they are now."""
        return self.document.labels

    def _forget(self, action: Action) -> None:
        for change in action.changes:
            if isinstance(change, MarksChange):
                self._solutions.pop(change.frame, None)
            else:
                self._solutions.clear()

    def solution(self, frame: int) -> FrameSolution | None:
        """The pose of a frame from its marks alone; None without a camera. Raises KeyError."""
        if self.project.camera is None:
            return None
        if frame not in self._solutions:
            view = view_of(self.labels, frame, self.project.frame(frame).stamp_ns)
            self._solutions[frame] = solve_frame(self.labels, view, self.project.camera, self.project.surface)
        return self._solutions[frame]

    @property
    def joint_is_current(self) -> bool:
        """Whether nothing has changed since all frames were solved jointly."""
        return self.joint is not None and self.joint.revision == self.document.revision

    def truth(self, frame: int) -> FrameSolution | None:
        """The pose that is saved as the truth: the joint one while it holds, else that of the frame alone."""
        if self.joint is not None and self.joint_is_current and frame in self.joint.solutions:
            return self.joint.solutions[frame]
        return self.solution(frame)

    def labelled(self) -> list[Frame]:
        """Frames with marks, in order."""
        return [frame for frame in self.project.frames if self.labels.marks(frame.number)]

    def solve_all(self) -> JointSolution:
        """All labelled frames in one. Raises ValueError where there is no camera, or no frame with enough marks.

        Does not change anything, so that it can run beside the page; `take_joint` does.
        """
        if self.project.camera is None:
            raise ValueError("expected a camera: put camera.yaml into the folder")
        labels, revision = self.labels, self.document.revision
        views = [view_of(labels, frame.number, frame.stamp_ns) for frame in self.labelled()]
        return solve_jointly(labels, views, self.project.camera, self.project.surface, revision)

    def take_joint(self, joint: JointSolution) -> None:
        """Let the joint poses be the truth until something changes."""
        self.joint = joint

    def next_frame(self, frame: int, step: int = 1) -> int:
        """Number of the frame `step` places on, the first or last at the ends. Raises KeyError."""
        numbers = [each.number for each in self.project.frames]
        place = numbers.index(self.project.frame(frame).number) + step
        return numbers[min(max(place, 0), len(numbers) - 1)]

    def propagate(self, frame: int) -> Propagated:
        """Carry the marks of a frame to the next. Raises InputError for an image, ValueError at the last frame."""
        following = self.next_frame(frame)
        if following == frame:
            raise ValueError("this is the last frame")
        here, there = self.project.frame(frame), self.project.frame(following)
        for each in (here, there):
            self.project.check_frame(each)
        marks = self.labels.marks(frame)
        before = self.next_frame(frame, -1)
        earlier = self.solution(before) if before != frame else None
        present = self.labels.marks(following)
        carried = carry_marks(
            marks,
            present,
            self._grey(here.path),
            self._grey(there.path),
            expected_shifts(earlier, self.solution(frame)),
        )
        if self.project.camera is not None:
            carried, _ = without_outliers(self.labels, following, carried, self.project.camera, self.project.surface)
        self.document.set_marks(following, carried, f"carry marks to frame {following}")
        wanted = sum(not mark.hidden for mark in marks.values())
        found = sum(not carried[n].hidden for n in marks if n in carried and not marks[n].hidden)
        return Propagated(frame=following, carried=found, lost=wanted - found)

    def pick(self, position: Sequence[float], *, snap: bool) -> Triple:
        """Where a pick on the mesh means: the corner beside it with `snap`, else the pick itself."""
        point = np.array(position, dtype=np.float64)
        surface = self.project.surface
        if surface is None or not snap:
            return triple(point if surface is None else surface.nearest(point))
        corners = surface.vertices[np.unique(surface.edges.ends)]
        gaps = np.linalg.norm(corners - point, axis=1)
        near = int(np.argmin(gaps)) if len(gaps) else 0
        return triple(corners[near] if len(gaps) and gaps[near] < SNAP * surface.size_m else surface.nearest(point))

    @property
    def default_sigma_m(self) -> float:
        """For a new landmark [m]: two digits are enough."""
        size = 1.0 if self.project.surface is None else self.project.surface.size_m
        return float(f"{SIGMA_SHARE * size:.1g}")

    def suggest(self, count: int) -> int:
        """Add up to `count` corners of the mesh; returns how many were found. Raises ValueError without a mesh."""
        if self.project.surface is None:
            raise ValueError("expected a mesh: put one into the folder")
        found = suggest_landmarks(self.project.surface, count, self.labels.positions)
        sigma_m = self.default_sigma_m
        taken = {each.name for each in self.labels.landmarks}
        names = (name for i in range(1, len(taken) + count + 1) if (name := f"p{i}") not in taken)
        new = {
            name: (triple(X), (sigma_m, sigma_m, sigma_m))
            for X, name in zip(found.positions.tolist(), names, strict=False)
        }
        if new:
            self.document.add_landmarks(new)
        return len(new)

    def save(self) -> Exported:
        """Write every file. Raises OSError, and ValueError without landmarks."""
        solutions = {frame.number: self.truth(frame.number) for frame in self.labelled()}
        known = {number: each for number, each in solutions.items() if each is not None}
        return export_all(self.project, known, self.joint if self.joint_is_current else None)


def _read_grey(path: Path) -> opencv.GreyImage:
    return opencv.grey(opencv.read_image(path))
