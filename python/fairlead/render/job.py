# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What one sequence is: everything that decides its pixels, and nothing else."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal, Protocol, runtime_checkable

import numpy as np

from fairlead.render.errors import RenderError
from fairlead.render.flights import Placed
from fairlead.render.images import LinearImage, TruthImage
from fairlead.render.sky import Sky
from fairlead.render.surface import Surface
from fairlead.render.surface_file import load_surface
from fairlead.render.surroundings import Kind, Surroundings, at_sea, in_space
from fairlead.render.weather import Weather
from fairlead.types import Camera, Target, Vector3

Quality = Literal["full", "draft"]


@dataclass(frozen=True, kw_only=True)
class Setting:
    """Light and sea of a sequence."""

    surroundings: Kind = "sea"
    sun_elevation_deg: float = 35.0
    sun_azimuth_deg: float = 235.0
    """From the target's x axis to its y axis; the ship steams along x."""
    wind_m_s: float = 7.5
    wind_azimuth_deg: float = 150.0
    """Where the waves go, from x."""
    cloud: float = 0.3
    overcast: float = 0.0
    speed_m_s: float = 9.0
    """Of the ship."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Job:
    """One sequence. The same job gives the same pictures, frame by frame, in any order."""

    target: Target
    camera: Camera
    placed: tuple[Placed, ...]
    folder: Path
    quality: Quality = "full"
    samples: int = 16
    """Light paths per pixel, full quality only."""
    threads: int | None = None
    """Of Cycles; one per core if None."""
    setting: Setting = Setting()
    weather: Weather | None = None
    seed: int = 0
    depth: bool = False
    """Write depth images."""
    reuse: Path | None = None
    """A folder of another run of the same sequence: its linear light is developed, nothing is rendered."""

    def surface(self) -> Surface:
        """The target's mesh. Raises RenderError if it has none, InputError if it cannot be read."""
        if self.target.mesh is None:
            raise RenderError(f'target {self.target.name} names no mesh: add mesh = "..." to its target.toml')
        return load_surface(self.target.mesh)

    def surrounded(self, surface: Surface, *, fine_sky: bool = False) -> Surroundings:
        """Sky, sea and wake, drawn from the seed."""
        s, rng = self.setting, np.random.default_rng([self.seed, 1])
        elevation, azimuth = float(np.radians(s.sun_elevation_deg)), float(np.radians(s.sun_azimuth_deg))
        if s.surroundings == "space":
            return in_space(rng, sun_elevation_rad=elevation, sun_azimuth_rad=azimuth)
        return at_sea(
            surface,
            rng,
            sun_elevation_rad=elevation,
            sun_azimuth_rad=azimuth,
            cloud=s.cloud,
            overcast=s.overcast,
            wind_m_s=s.wind_m_s,
            speed_m_s=s.speed_m_s,
            fine_sky=fine_sky,
        )


@runtime_checkable
class Backend(Protocol):
    """A renderer of one job."""

    def render(self, placed: Placed) -> tuple[LinearImage, TruthImage]:
        """Linear light and truth of one frame."""
        ...


def horizon(sky: Sky) -> Vector3:
    """Radiance just above the horizon, mean of all around."""
    rows = max(2, len(sky.radiance) // 12)
    return sky.radiance[:rows].mean(axis=(0, 1)).astype(np.float64)


def open_backend(job: Job) -> Backend:
    """The renderer that the job asks for. Raises RenderError where this machine has none."""
    if job.quality == "draft":
        from fairlead.render.raster.backend import RasterBackend

        return RasterBackend(job)
    from fairlead.render.cycles.backend import CyclesBackend

    return CyclesBackend(job)
