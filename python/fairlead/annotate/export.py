# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The labels as the files that everything else reads: target.toml, observations.csv, truth.csv, annotations.json."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fairlead.annotate.labels import Labels, Landmark
from fairlead.annotate.project import Frame, Project, landmarks_of
from fairlead.annotate.solve import FrameSolution, JointSolution, target_of, view_of
from fairlead.cameras import project as project_points
from fairlead.geometry import transform
from fairlead.io.coco import LabelledImage, label_json, write_coco
from fairlead.io.observations import write_views
from fairlead.io.poses import write_poses
from fairlead.io.target import save_prior, save_target
from fairlead.types import Camera, Pixels, Target


@dataclass(frozen=True, kw_only=True)
class Exported:
    """What was written."""

    files: tuple[Path, ...]
    labelled: int
    """Frames with marks."""
    posed: int
    """Frames with a pose."""

    def __str__(self) -> str:
        return f"{', '.join(path.name for path in self.files)}: {self.labelled} frames labelled, {self.posed} with pose"


def export_all(project: Project, solutions: Mapping[int, FrameSolution], joint: JointSolution | None) -> Exported:
    """Write every file there is something to say for; each replaces the old one at once.

    `solutions` are the poses to be told as the truth, by frame; `joint` the refined landmarks beside them. Raises
    OSError, and ValueError without landmarks.
    """
    labels, folder = project.document.labels, project.folder
    files = [folder / "target.toml"]
    _save_target(files[0], project)
    if joint is not None:
        files.append(folder / "target_refined.toml")
        save_target(files[-1], _named(joint, project))
    labelled = [frame for frame in project.frames if labels.marks(frame.number)]
    posed = [frame for frame in project.frames if frame.number in solutions and solutions[frame.number].estimate.ok]
    if labelled:
        files.append(folder / "observations.csv")
        _replace(files[-1], lambda path: write_views(path, [view_of(labels, f.number, f.stamp_ns) for f in labelled]))
    if posed and project.camera is not None:
        files.append(folder / "truth.csv")
        _replace(files[-1], lambda path: write_poses(path, [solutions[f.number].estimate for f in posed]))
        files.append(folder / "annotations.json")
        _write_coco(files[-1], project, posed, solutions, project.camera)
    return Exported(files=tuple(files), labelled=len(labelled), posed=len(posed))


def _save_target(path: Path, project: Project) -> None:
    """Write target.toml; where it says something else, that is kept as target.toml.old. What is equal is left alone."""
    labels, told = project.document.labels, project.told
    if told is not None and path.exists() and landmarks_of(told) == _renumbered(labels.landmarks):
        return
    names = {each.name for each in labels.landmarks}
    target = target_of(labels, project.name, None if project.surface is None else project.surface.path)
    if told is not None:
        distances = tuple(each for each in told.distances if set(each.between) <= names)
        target = replace(target, motion=told.motion, touchdown=told.touchdown, distances=distances)
    part = path.with_name(f".part.{path.name}")
    save_prior(part, target, labels.sigmas)
    if path.exists() and path.read_bytes() != part.read_bytes():
        path.replace(path.with_name(f"{path.name}.old"))
    part.replace(path)


def _renumbered(landmarks: Sequence[Landmark]) -> tuple[Landmark, ...]:
    return tuple(replace(each, number=number) for number, each in enumerate(landmarks))


def _named(joint: JointSolution, project: Project) -> Target:
    mesh = None if project.surface is None else project.surface.path
    return replace(joint.refinement.model, name=project.name, mesh=mesh)


def _replace(path: Path, write: Callable[[Path], None]) -> None:
    """Write beside it, then put it in the old one's place."""
    part = path.with_name(f".part.{path.name}")
    write(part)
    part.replace(path)


def _write_coco(
    path: Path, project: Project, posed: Sequence[Frame], solutions: Mapping[int, FrameSolution], camera: Camera
) -> None:
    labels = project.document.labels
    images = [_labelled(labels, project, frame, solutions[frame.number], camera) for frame in posed]
    names = [each.name for each in labels.landmarks]
    write_coco(path, project.name, names, [label_json(image) for image in images], made="labelled with")


def _labelled(labels: Labels, project: Project, frame: Frame, solution: FrameSolution, camera: Camera) -> LabelledImage:
    """Marked: where it was marked; not marked: where the pose has it, visible unless something hides it."""
    marks = labels.marks(frame.number)
    pixels = np.zeros((len(labels.landmarks), 2))
    visibility: list[int] = []
    for row, landmark in enumerate(labels.landmarks):
        mark = marks.get(landmark.number)
        u, v = solution.projected.get(landmark.number, (np.nan, np.nan))
        inside = -0.5 <= u <= camera.width - 0.5 and -0.5 <= v <= camera.height - 0.5
        if mark is not None and not mark.hidden:
            pixels[row], seen = (mark.u_px, mark.v_px), 2
        elif inside:
            hidden = (mark is not None and mark.hidden) or landmark.number not in solution.in_sight
            pixels[row], seen = (u, v), 1 if hidden else 2
        else:
            seen = 0
        visibility.append(seen)
    T = solution.estimate.T_camera_target
    outline = labels.positions if project.surface is None else project.surface.vertices
    return LabelledImage(
        number=frame.number,
        file_name=_relative(frame.path, project.folder),
        width=camera.width,
        height=camera.height,
        pixels=pixels,
        visibility=tuple(visibility),
        box=_box(project_points(camera, transform(T, outline)), camera),
        K=camera.K,
        T_camera_target=T,
    )


def _box(pixels: Pixels, camera: Camera) -> tuple[float, float, float, float]:
    """Of the points in front of the camera, cut off at the image: x, y, width, height [px]."""
    seen = pixels[np.isfinite(pixels).all(axis=1)]
    if not len(seen):
        return (0.0, 0.0, 0.0, 0.0)
    low = np.clip(seen.min(axis=0), -0.5, [camera.width - 0.5, camera.height - 0.5])
    high = np.clip(seen.max(axis=0), -0.5, [camera.width - 0.5, camera.height - 0.5])
    return (float(low[0]), float(low[1]), float(high[0] - low[0]), float(high[1] - low[1]))


def _relative(path: Path, folder: Path) -> str:
    resolved = path.resolve()
    inside = resolved.is_relative_to(folder.resolve())
    return resolved.relative_to(folder.resolve()).as_posix() if inside else str(resolved)
