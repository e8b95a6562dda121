# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What `fairlead render` does with its arguments."""

from pathlib import Path

import numpy as np

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
from fairlead.render.surroundings import Kind
from fairlead.render.weather import Kind as WeatherKind
from fairlead.render.weather import Weather
from fairlead.types import Target

CROPS = "crops"
NEAR, FAR = 2.1, 20.9
"""Range of crops in units of the landmarks' diagonal: 0.3 to 3 km for the frigate."""


def render(
    sequence: str,
    output: Path,
    *,
    target: Path | None = None,
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
    size: int = 256,
    seed: int = 0,
    jobs: int = 1,
    threads: int | None = None,
    progress: ProgressFactory = silent,
) -> int:
    """Render crops, a named flight, or the poses of a truth.csv. Returns how many pictures were made.

    Raises RenderError (what this machine or this target cannot do) or InputError, one line each.
    """
    folder = shipped_data("frigate") if target is None else target.parent
    model = load_target(folder / "target.toml" if target is None else target)
    lens = load_camera(folder / "camera.yaml" if camera is None else camera)
    check_pinhole(lens)
    if sequence == CROPS:
        from fairlead.render.crops import CropJob, render_crops

        crops = CropJob(
            target=model,
            camera=lens,
            folder=output,
            count=count,
            empty_share=empty,
            envelope=_envelope(model, surroundings),
            size=size,
            seed=seed,
            surroundings=surroundings,
            quality=quality or "draft",
            samples=samples,
            threads=threads,
        )
        return render_crops(crops, jobs=jobs, progress=progress)
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


def _envelope(target: Target, surroundings: Kind) -> Envelope:
    """Where crops are seen from."""
    low, high = target.positions.min(axis=0), target.positions.max(axis=0)
    size = float(np.linalg.norm(high - low))
    elevations = (2.0, 40.0) if surroundings == "sea" else (-80.0, 80.0)
    return Envelope(ranges_m=(NEAR * size, FAR * size), elevations_deg=elevations)
