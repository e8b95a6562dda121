# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What the target is in: a sea under a sky, space, or a room. The first two are the same for both renderers."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from fairlead.render.sky import SUN, Backdrop, Sky, make_sky
from fairlead.render.surface import Surface
from fairlead.render.wake import Hull, WakeMap, make_wake
from fairlead.types import Vector3, Vector4

Kind = Literal["sea", "space", "room"]

WATER = (0.0010, 0.0060, 0.0120)
"""Radiance that comes up out of the water, per irradiance on it [1/sr]."""
CLEAR_AIR_M = 70_000.0
"""How far one sees on a clear day [m]; contrast then is 2 %."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Surroundings:
    """Light, air, water and wake of one flight; the world's z is up and its sea level 0."""

    kind: Kind
    sky: Sky
    wake: tuple[WakeMap, WakeMap] | None = None
    wind_m_s: float = 8.0
    weathering: float = 0.5
    """Rust and stains on the target [0..1]."""
    water: tuple[float, float, float] = WATER
    earth: Vector4 | None = None
    """In space: direction of the earth, cosine of its angular radius."""

    backdrop: Backdrop | None = None
    """In a room: what is behind everything; `sky` then is its upper half."""

    @property
    def air_per_m(self) -> float:
        """What clear air takes of the light [1/m]: Koschmieder, contrast 2 % at the visibility."""
        return 3.912 / CLEAR_AIR_M if self.kind == "sea" else 0.0

    @property
    def from_below(self) -> Vector3:
        """Radiance of the lower hemisphere, for the light on what looks down."""
        if self.kind == "space":
            return np.zeros(3)
        if self.backdrop is not None:
            return self.backdrop[len(self.backdrop) // 2 :: 8, ::8].mean(axis=(0, 1), dtype=np.float64)
        return self.sky.irradiance * 0.03 + np.array(self.water) * self.sky.level_irradiance

    @property
    def metered(self) -> float:
        """Irradiance that a light meter sets the exposure by: of level ground, in a room of what faces anywhere."""
        if self.backdrop is None:
            return self.sky.level_irradiance
        lamp = float(self.sky.sun_irradiance.mean())
        return np.pi * float(self.backdrop[::8, ::8].mean(dtype=np.float64)) + 0.25 * lamp


def waterline(surface: Surface) -> Hull:
    """The hull of a floating surface: the box of what lies within a tenth of its height of z = 0."""
    low, high = surface.corners
    band = 0.1 * (high[2] - low[2])
    near = surface.vertices[np.abs(surface.vertices[:, 2]) <= band]
    if len(near) < 3:
        near = surface.vertices
    return Hull(
        stern=float(near[:, 0].min()), bow=float(near[:, 0].max()), beam=float(near[:, 1].max() - near[:, 1].min())
    )


def at_sea(
    surface: Surface,
    rng: np.random.Generator,
    *,
    sun_elevation_rad: float,
    sun_azimuth_rad: float,
    cloud: float = 0.35,
    overcast: float = 0.0,
    wind_m_s: float = 8.0,
    speed_m_s: float = 9.0,
    weathering: float = 0.5,
    fine_sky: bool = False,
) -> Surroundings:
    """A target under way at sea."""
    size = {"rows": 512, "columns": 2048} if fine_sky else {}
    sky = make_sky(sun_elevation_rad, sun_azimuth_rad, rng, cloud=cloud, overcast=overcast, **size)
    wake = make_wake(waterline(surface), speed_m_s)
    return Surroundings(kind="sea", sky=sky, wake=wake, wind_m_s=wind_m_s, weathering=weathering)


def in_space(rng: np.random.Generator, *, sun_elevation_rad: float, sun_azimuth_rad: float) -> Surroundings:
    """Hard sunlight, a little of it back from the earth, which is somewhere below."""
    e, a = sun_elevation_rad, sun_azimuth_rad
    sun = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    azimuth = rng.uniform(0.0, 2.0 * np.pi)
    down = np.array([0.7 * np.cos(azimuth), 0.7 * np.sin(azimuth), -0.714])
    dim = np.full((8, 32, 3), 0.05, np.float32)
    sky = Sky(radiance=dim, sun_direction=sun, sun_irradiance=SUN.copy(), overcast=0.0)
    earth = np.array([*down, np.cos(np.radians(62.0))])
    return Surroundings(kind="space", sky=sky, weathering=0.0, earth=earth)
