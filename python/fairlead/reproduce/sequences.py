# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Sequences with truth: rendered folders, clips, or a user's own. docs/reproduce.md section 2."""

import gzip
import hashlib
import shutil
from collections.abc import Sequence as Rows
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fairlead.geometry import project, transform
from fairlead.io.camera import load_camera
from fairlead.io.csv_lines import integer_cell, number_cell, read_csv
from fairlead.io.errors import InputError
from fairlead.io.poses import read_truth
from fairlead.io.target import load_target
from fairlead.types import Camera, Pixels, Target, TruthPose
from fairlead.video.clip import CLIP

ORDER = ("orbit-2.0", "rendezvous-10", "rendezvous-20", "rendezvous-30")
"""The published ones, in the order of the published tables; others follow by name."""
_LANDMARK_COLUMNS = ("frame", "stamp_ns", "landmark", "u_px", "v_px", "depth_m", "state")


@dataclass(frozen=True, kw_only=True, eq=False)
class SeenTruth:
    """Where the landmarks really are in the image of one frame."""

    pixels: Pixels
    """NaN behind the camera, one row per landmark of the target."""
    visible: np.ndarray
    """(n,) bool; all of them where nobody said."""
    outside: np.ndarray
    """(n,) bool: beyond the image."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Sequence:
    """One sequence; `true` and `told` have the same landmarks in the same order."""

    name: str
    folder: Path
    camera: Camera
    camera_path: Path
    true: Target
    """Exact landmarks."""
    prior: Target
    """Covariance that the told models are drawn with, and told."""
    truth: tuple[TruthPose, ...]
    seen: dict[int, SeenTruth]
    """By frame."""

    @property
    def images(self) -> Path | None:
        """What a detector looks at; None where there are tables only."""
        if (self.folder / CLIP).is_file():
            return self.folder / CLIP
        return self.folder if (self.folder / "rgb").is_dir() else None

    @property
    def T_true(self) -> np.ndarray:
        """(k, 4, 4)"""
        return np.array([pose.T_camera_target for pose in self.truth])

    @property
    def frames(self) -> tuple[int, ...]:
        """Numbers of the frames with truth, in order."""
        return tuple(pose.frame for pose in self.truth)

    def told(self, seed: int) -> Target:
        """A model that is wrong by the prior: X0 ~ N(X, P0); the same for every method of this seed."""
        rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(20_240_626,)))
        P0 = self.prior.covariance
        values, vectors = np.linalg.eigh(P0)
        errors = vectors @ (np.sqrt(np.maximum(values, 0.0)) * rng.standard_normal(len(values)))
        return replace(
            self.prior, positions=self.true.positions + errors.reshape(-1, 3), mesh=None, touchdown=None, distances=()
        )


def find_sequences(folders: Rows[Path], target: Path, scratch: Path) -> list[Sequence]:
    """Every folder with a truth.csv in these folders, or these folders themselves. Raises InputError."""
    found: dict[str, Path] = {}
    for folder in folders:
        candidates = [folder] if (folder / "truth.csv").is_file() else sorted(folder.glob("*/"))
        found |= {each.name: each for each in candidates if (each / "truth.csv").is_file()}
    known = [name for name in ORDER if name in found]
    names = [*known, *sorted(name for name in found if name not in ORDER)]
    return [load_sequence(found[name], target, scratch) for name in names]


def load_sequence(folder: Path, target: Path, scratch: Path) -> Sequence:
    """Read truth, camera and landmarks. `target`: how well the landmarks are known, and where they truly are.

    target_true.toml in the folder, if there is one, says better where they are. Raises InputError.
    """
    own = folder / "target.toml"
    prior = load_target(own if own.is_file() else target)
    exact = folder / "target_true.toml"
    true = load_target(exact) if exact.is_file() else prior
    if true.landmarks != prior.landmarks:
        raise InputError(exact, "expected the landmarks of the target in the same order")
    camera_path = folder / "camera.yaml"
    camera = load_camera(camera_path)
    truth = tuple(read_truth(folder / "truth.csv"))
    if not truth:
        raise InputError(folder / "truth.csv", "holds no poses")
    return Sequence(
        name=folder.name,
        folder=folder,
        camera=camera,
        camera_path=camera_path,
        true=replace(true, covariance=np.zeros_like(true.covariance)),
        prior=prior,
        truth=truth,
        seen=_seen(folder, true, camera, truth, scratch),
    )


def _seen(folder: Path, true: Target, camera: Camera, truth: Rows[TruthPose], scratch: Path) -> dict[int, SeenTruth]:
    table = folder / "landmarks_true.csv"
    packed = table.with_name(f"{table.name}.gz")
    if not table.is_file() and packed.is_file():
        table = _unpacked(packed, scratch)
    if table.is_file():
        return _read_seen(table, true)
    return {pose.frame: _projected(true, camera, pose) for pose in truth}


def _projected(true: Target, camera: Camera, pose: TruthPose) -> SeenTruth:
    """Where truth puts the landmarks; which of them are hidden is not known."""
    pixels = project(camera, transform(pose.T_camera_target, true.positions))
    with np.errstate(invalid="ignore"):
        within = (pixels >= -0.5) & (pixels <= np.array([camera.width, camera.height]) - 0.5)
    inside = np.asarray(within.all(axis=1))
    return SeenTruth(pixels=pixels, visible=inside, outside=~inside)


def _read_seen(path: Path, true: Target) -> dict[int, SeenTruth]:
    place = {name: j for j, name in enumerate(true.landmarks)}
    n = len(place)
    pixels: dict[int, np.ndarray] = {}
    states: dict[int, list[str]] = {}
    for line, cells in read_csv(path, _LANDMARK_COLUMNS):
        frame = integer_cell(cells, "frame", path, line)
        j = place.get(cells["landmark"])
        if j is None:
            raise InputError(path, f"the target has no landmark {cells['landmark']!r}", line=line)
        if frame not in pixels:
            pixels[frame], states[frame] = np.full((n, 2), np.nan), ["outside"] * n
        pixels[frame][j] = [number_cell(cells, name, path, line) for name in ("u_px", "v_px")]
        states[frame][j] = cells["state"]
    return {
        frame: SeenTruth(
            pixels=pixels[frame],
            visible=np.array([state == "visible" for state in states[frame]]),
            outside=np.array([state == "outside" for state in states[frame]]),
        )
        for frame in pixels
    }


def _unpacked(path: Path, scratch: Path) -> Path:
    """The text of a .gz, beside the other things that can be made again."""
    digest = hashlib.sha256(path.read_bytes()).hexdigest()[:16]
    scratch.mkdir(parents=True, exist_ok=True)
    plain = scratch / f"{digest}.csv"
    if not plain.is_file():
        part = plain.with_name(f".{plain.name}.part")
        try:
            with gzip.open(path, "rb") as packed, part.open("wb") as stream:
                shutil.copyfileobj(packed, stream)
        except (OSError, EOFError) as error:
            raise InputError(path, f"cannot be unpacked: {error}") from error
        part.replace(plain)
    return plain
