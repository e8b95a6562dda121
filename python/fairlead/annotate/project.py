# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The folder that is annotated: mesh, camera, frames, and the labels in it, checked against one another."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fairlead.annotate.document import Document
from fairlead.annotate.journal import Header, Journal
from fairlead.annotate.labels import Labels, Landmark, triple
from fairlead.annotate.surface import Surface
from fairlead.io.errors import InputError
from fairlead.opencv import image_size
from fairlead.types import Camera, Target

JOURNAL = "labels.jsonl"
ON_SURFACE = 0.05
"""Labels whose landmarks lie farther from another mesh than this share of their extent do not belong to it [-]."""
SIZES_M = (0.01, 2000.0)
"""Smaller or larger targets are probably in another unit."""


@dataclass(frozen=True, kw_only=True)
class Frame:
    """One image."""

    number: int
    stamp_ns: int
    path: Path


@dataclass(frozen=True, kw_only=True, eq=False)
class Project:
    """Everything that the page shows."""

    folder: Path
    name: str
    surface: Surface | None
    camera: Camera | None
    frames: tuple[Frame, ...]
    document: Document
    journal: Journal
    told: Target | None = None
    """What target.toml said when it was opened."""
    notices: tuple[str, ...] = ()
    """What a person should know before the first click."""

    def frame(self, number: int) -> Frame:
        """By its number. Raises KeyError."""
        for frame in self.frames:
            if frame.number == number:
                return frame
        raise KeyError(number)

    def check_frame(self, frame: Frame) -> None:
        """Raises InputError for an image that is none, is too large, or is not of the camera's size."""
        size = image_size(frame.path)
        if self.camera is not None and size != (self.camera.width, self.camera.height):
            expected = f"expected {self.camera.width} x {self.camera.height} as the camera has"
            raise InputError(frame.path, f"{expected}, got an image of {size[0]} x {size[1]}")


def open_project(
    folder: Path,
    *,
    surface: Surface | None = None,
    camera: Camera | None = None,
    target: Target | None = None,
    frames: Sequence[Frame] = (),
) -> Project:
    """Open the labels of a folder, or begin them with the landmarks of `target`.

    Raises InputError: labels of another target or mesh, labels that are open elsewhere or malformed; nothing has been
    changed then.
    """
    told_name = folder.resolve().name if target is None else target.name
    header = Header(
        target=told_name,
        mesh="" if surface is None else surface.path.name,
        mesh_sha256="" if surface is None else surface.sha256,
    )
    path = folder / JOURNAL
    is_new = not path.exists() or path.stat().st_size == 0
    journal = Journal(path, header)
    try:
        notices = [*_size_notices(surface)]
        labels = journal.written.labels
        if is_new and target is not None:
            labels = Labels(landmarks=landmarks_of(target))
            journal.start_over(header, labels)
        elif not is_new:
            notices += _check_belonging(journal, labels, surface, target)
            if journal.written.torn:
                notices.append("the last action was cut off when the program was stopped; all before it is here")
            if journal.is_long or _mesh_was_edited(journal, surface):
                journal.start_over(replace(header, target=journal.written.header.target), labels)
    except BaseException:
        journal.close()
        raise
    return Project(
        folder=folder,
        name=told_name if is_new else journal.written.header.target,
        surface=surface,
        camera=camera,
        frames=tuple(frames),
        document=Document(labels, journal.record),
        journal=journal,
        told=target,
        notices=tuple(notices),
    )


def landmarks_of(target: Target) -> tuple[Landmark, ...]:
    """With the roots of the diagonal of the prior as sigmas."""
    sigmas = np.sqrt(np.clip(np.diag(target.covariance), 0.0, None)).reshape(-1, 3)
    return tuple(
        Landmark(number=number, name=name, position_m=triple(position), sigma_m=triple(sigma))
        for number, (name, position, sigma) in enumerate(
            zip(target.landmarks, target.positions.tolist(), sigmas.tolist(), strict=True)
        )
    )


def _size_notices(surface: Surface | None) -> list[str]:
    if surface is None or SIZES_M[0] <= surface.size_m <= SIZES_M[1]:
        return []
    return [
        f"{surface.path.name} is {surface.size_m:.4g} m from corner to corner. Meshes carry no unit: if this one is in "
        "millimetres, start again with --mesh-scale 0.001"
    ]


def _mesh_was_edited(journal: Journal, surface: Surface | None) -> bool:
    return surface is not None and journal.written.header.mesh_sha256 != surface.sha256


def _check_belonging(journal: Journal, labels: Labels, surface: Surface | None, target: Target | None) -> list[str]:
    """Labels, mesh and target.toml are of the same target. Raises InputError; returns what is only odd."""
    notices: list[str] = []
    if surface is not None and labels.landmarks and _mesh_was_edited(journal, surface):
        off = surface.distance_m(labels.positions)
        extent = float(np.linalg.norm(np.ptp(labels.positions, axis=0))) or surface.size_m
        if np.median(off) > ON_SURFACE * min(surface.size_m, extent):
            was = journal.written.header.mesh or "none"
            raise InputError(
                journal.path,
                f"these labels are not of {surface.path.name}: their landmarks lie up to {max(off):.3g} m off it "
                f"(they were made on {was}); expected that mesh, or another folder",
            )
        notices.append(f"{surface.path.name} has changed since the last time; the landmarks are kept as they are")
    if target is not None and labels.landmarks:
        here, there = {each.name for each in labels.landmarks}, set(target.landmarks)
        if not here & there:
            few = ", ".join(sorted(there)[:3])
            raise InputError(
                journal.path,
                f"these labels are of another target ({journal.written.header.target}): none of their landmarks is in "
                f"target.toml ({few}, ...); expected labels of {target.name}, or another folder",
            )
        if here != there or not np.allclose(_positions(target, labels), labels.positions, atol=1e-9):
            notices.append("target.toml differs from the landmarks here, which are newer or older; Save writes these")
    return notices


def _positions(target: Target, labels: Labels) -> np.ndarray:
    of = dict(zip(target.landmarks, target.positions, strict=True))
    return np.array([of[each.name] for each in labels.landmarks])
