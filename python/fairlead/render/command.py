# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What `fairlead render` does with its arguments."""

from pathlib import Path

import numpy as np

from fairlead import geometry
from fairlead.io.camera import load_camera
from fairlead.io.errors import InputError
from fairlead.io.poses import read_truth
from fairlead.io.shipped import shipped_data
from fairlead.io.target import load_target
from fairlead.progress import ProgressFactory, silent
from fairlead.render.crop_view import Envelope
from fairlead.render.errors import RenderError
from fairlead.render.flights import FLIGHTS, FRIGATE_M, Placed, Swell, fly, placed_from_truth
from fairlead.render.job import Job, Quality, Setting
from fairlead.render.raster.matrices import check_pinhole
from fairlead.render.surface_file import save_surface
from fairlead.render.surroundings import Kind
from fairlead.render.weather import Kind as WeatherKind
from fairlead.render.weather import Weather
from fairlead.types import Matrix3, Target, Vector3

CROPS, TAGS = "crops", "tags"
NEAR, FAR = 2.1, 20.9
"""Range of crops in units of the landmarks' diagonal: 0.3 to 3 km for the frigate."""
IN_REACH = (2.5, 12.0)
"""The same in a room."""


def render(
    sequence: str,
    output: Path,
    *,
    target: Path | None = None,
    dictionary: str | None = None,
    quiet: float = 1.0,
    handle: tuple[float, float, float] | None = None,
    up: tuple[float, float, float] = (0.0, 0.0, 1.0),
    camera: Path | None = None,
    quality: Quality | None = None,
    samples: int = 16,
    surroundings: Kind = "sea",
    weather: WeatherKind | None = None,
    strength: float = 0.5,
    sun_elevation_deg: float = 35.0,
    wind_m_s: float = 7.5,
    swell: bool = False,
    stride: int = 5,
    first: int = 0,
    frames: int | None = None,
    depth: bool = False,
    reuse: Path | None = None,
    clip: Path | None = None,
    crf: float = 24.0,
    count: int = 1000,
    empty: float = 0.0,
    weathered: float = 0.35,
    size: int = 256,
    seed: int = 0,
    jobs: int = 1,
    threads: int | None = None,
    progress: ProgressFactory = silent,
) -> int:
    """Render crops, a named flight, or the poses of a truth.csv, or write the mesh of a bundle of tags.

    Returns how many pictures were made. Raises RenderError (what this machine or this target cannot do) or
    InputError, one line each.
    """
    folder = shipped_data("frigate") if target is None else target.parent
    model = load_target(folder / "target.toml" if target is None else target)
    if sequence == TAGS:
        _write_tags(model, output, dictionary, quiet, handle)
        return 0
    if surroundings == "room" and (sequence != CROPS or quality == "full"):
        raise RenderError(
            "--surroundings room: there are crops of draft quality, no flights and nothing at full quality"
        )
    lens = load_camera(folder / "camera.yaml" if camera is None else camera)
    if sequence == CROPS:
        from fairlead.render.crops import CropJob, render_crops

        crops = CropJob(
            target=model, camera=lens, folder=output, count=count, empty_share=empty, weather_share=weathered,
            envelope=envelope_of(model, surroundings, up), size=size, seed=seed, surroundings=surroundings,
            quality=quality or "draft", samples=samples, threads=threads,
        )  # fmt: skip
        return render_crops(crops, jobs=jobs, progress=progress)
    check_pinhole(lens)
    flown = _placed(sequence, model, stride, Swell() if swell else None, surroundings)
    setting = Setting(surroundings=surroundings, sun_elevation_deg=sun_elevation_deg, wind_m_s=wind_m_s)
    job = Job(
        target=model,
        camera=lens,
        placed=_chosen(flown, first, frames),
        folder=output,
        quality=quality or "full",
        samples=samples,
        threads=threads,
        setting=setting,
        seed=seed,
        depth=depth,
        reuse=reuse,
        weather=None if weather is None else Weather(kind=weather, strength=strength, seed=seed),
    )
    return _made(job, jobs, clip, crf, progress)


def _made(job: Job, jobs: int, clip: Path | None, crf: float, progress: ProgressFactory) -> int:
    """Render what is missing and encode it if wanted; returns how many pictures were made."""
    from fairlead.render.sequence import render_sequence

    made = render_sequence(job, jobs=jobs, progress=progress)
    if clip is not None:
        from fairlead.render.clip import write_clip

        write_clip(job, clip, crf=crf, progress=progress)
    return made


def _chosen(flown: list[Placed], first: int, frames: int | None) -> tuple[Placed, ...]:
    """So many frames from the first wanted one on."""
    placed = [each for each in flown if each.frame >= first]
    if not placed:
        raise RenderError(f"--first {first}: the last frame is {flown[-1].frame}")
    return tuple(placed[:frames])


def _placed(sequence: str, target: Target, stride: int, swell: Swell | None, surroundings: Kind) -> list[Placed]:
    """The frames of a named flight or of a file of poses."""
    if sequence in FLIGHTS:
        low, high = target.positions.min(axis=0), target.positions.max(axis=0)
        scale = 1.0 if surroundings == "sea" else float(np.linalg.norm(high - low)) / FRIGATE_M
        return fly(sequence, target, stride=stride, scale=scale, swell=swell)
    path = Path(sequence)
    if path.suffix != ".csv":
        known = ", ".join((*FLIGHTS, CROPS))
        raise RenderError(f"{sequence}: expected {known}, or a truth.csv")
    if swell is not None:
        raise RenderError(f"--swell: the poses of {path} say already how the target moves")
    placed = placed_from_truth(read_truth(path))
    if not placed:
        raise InputError(path, "holds no poses")
    return placed[::stride] if stride > 1 else placed


def envelope_of(target: Target, surroundings: Kind, up: tuple[float, float, float]) -> Envelope:
    """Where crops are seen from."""
    low, high = target.positions.min(axis=0), target.positions.max(axis=0)
    size = float(np.linalg.norm(high - low))
    level = _upright(np.array(up))
    if surroundings == "room":
        near, far = (size * times for times in IN_REACH)
        return Envelope(ranges_m=(near, far), elevations_deg=(-50.0, 60.0), R_level_target=level, roll_deg=12.0)
    elevations = (2.0, 40.0) if surroundings == "sea" else (-80.0, 80.0)
    return Envelope(ranges_m=(NEAR * size, FAR * size), elevations_deg=elevations, R_level_target=level)


def _upright(up: Vector3) -> Matrix3:
    """The shortest turn of `up` to z: R up = z |up|. Raises RenderError for zeros."""
    length = float(np.linalg.norm(up))
    if not np.isfinite(length) or length == 0.0:
        raise RenderError(f"--up: expected a direction, got {up.tolist()}")
    axis = np.cross(up / length, [0.0, 0.0, 1.0])
    sine, cosine = float(np.linalg.norm(axis)), float(up[2] / length)
    if sine < 1e-9:
        return np.eye(3) if cosine > 0.0 else np.diag([1.0, -1.0, -1.0])
    return geometry.exp_so3(axis / sine * np.arctan2(sine, cosine))


def _write_tags(
    target: Target, path: Path, family: str | None, quiet: float, handle: tuple[float, float, float] | None
) -> None:
    """The mesh that the target's tags are on. Raises RenderError: no family, no tags, not a .ply."""
    from fairlead.render.tagged import tagged_surface

    if family is None or path.suffix.lower() != ".ply":
        raise RenderError("render tags: expected --dictionary, for example DICT_4X4_100, and a .ply file for -o")
    surface = tagged_surface(target, family, quiet=quiet, handle=None if handle is None else np.array(handle))
    path.parent.mkdir(parents=True, exist_ok=True)
    save_surface(path, surface)
