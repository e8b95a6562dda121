# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The sky: sunlight scattered once in a Rayleigh and Mie atmosphere, clouds, and what both shed on the sea.

Source: Nishita et al. 1993, Display of the Earth taking into account atmospheric scattering;
docs/rendering.md section 4.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float32, Float64

from fairlead.render.noise import fractal_tile, sample_tile
from fairlead.types import Vector3

EARTH_M, TOP_M = 6.371e6, 6.0e4
RAYLEIGH = np.array([5.8e-6, 13.5e-6, 33.1e-6])
"""Scattering at sea level, red, green, blue [1/m]; scale height 8 km."""
OZONE = np.array([0.65e-6, 1.88e-6, 0.085e-6])
MIE = 8.0e-6
"""Scattering of clear marine air at sea level [1/m]; scale height 1.2 km."""
MIE_FORWARD = 0.76
AGAIN = 0.2
"""Radiance that is scattered once more, in units of the sun's irradiance on level ground [1/sr]: measured skies have
about half of their light from there."""
SUN = np.array([1.0, 0.98, 0.95]) * np.pi
"""Irradiance of the sun outside the atmosphere, in units in which a white wall in full sun has radiance 1."""
ROWS, COLUMNS = 128, 512

SkyImage = Float32[np.ndarray, "r c 3"]
Backdrop = Float32[np.ndarray, "h w 3"]
"""Radiance all around: row r is the angle pi (r + 0.5) / h from straight up, column c the azimuth as in a Sky."""
Harmonics = Float64[np.ndarray, "9 3"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Sky:
    """Radiance of the upper hemisphere and the sun's light. World axes: z up, azimuth from x."""

    radiance: SkyImage
    """Row r is the elevation pi/2 ((r + 0.5) / rows)^2, so that rows are dense at the horizon; column c is the
    azimuth 2 pi (c + 0.5) / columns."""
    sun_direction: Vector3
    """Unit, towards the sun."""
    sun_irradiance: Vector3
    """On a plane that faces the sun."""
    overcast: float

    @cached_property
    def irradiance(self) -> Vector3:
        """Of the sky alone, on a level plane."""
        elevation, weight = _solid_angles(*self.radiance.shape[:2])
        return (self.radiance * (weight * np.sin(elevation))[:, None, None]).sum(axis=(0, 1), dtype=np.float64)

    @property
    def level_irradiance(self) -> float:
        """Of sun and sky on a level plane, mean of the colours: what an exposure is set by."""
        return float((self.irradiance + self.sun_irradiance * max(self.sun_direction[2], 0.0)).mean())


def make_sky(
    sun_elevation_rad: float,
    sun_azimuth_rad: float,
    rng: np.random.Generator,
    *,
    cloud: float = 0.35,
    overcast: float = 0.0,
    rows: int = ROWS,
    columns: int = COLUMNS,
) -> Sky:
    """Clear sky, clouds that cover a share `cloud` of it, and a grey veil: `overcast` 1 hides the sun."""
    e = sun_elevation_rad
    sun = np.array([np.cos(e) * np.cos(sun_azimuth_rad), np.cos(e) * np.sin(sun_azimuth_rad), np.sin(e)])
    elevation, _ = _solid_angles(rows, columns)
    azimuth = 2.0 * np.pi * (np.arange(columns) + 0.5) / columns
    half = np.linspace(0.0, np.pi, 33)  # the clear sky is symmetric about the sun's azimuth
    coarse = _whitened(_scattered(elevation, half, e), elevation, e)
    from_sun = np.abs((azimuth - sun_azimuth_rad + np.pi) % (2.0 * np.pi) - np.pi)
    place = np.clip(from_sun / np.pi * 32.0, 0.0, 31.999)
    left = place.astype(int)
    share = (place - left)[None, :, None]
    clear = coarse[:, left] * (1.0 - share) + coarse[:, left + 1] * share
    through = _transmittance(np.array([max(np.sin(e), -0.02)]))[0]
    direct = SUN * through * float(np.clip((np.degrees(e) + 1.0) / 2.0, 0.0, 1.0))
    radiance = _with_clouds(clear, elevation, azimuth, sun, direct, cloud, rng)
    _, weight = _solid_angles(rows, columns)
    light = (clear * (weight * np.sin(elevation))[:, None, None]).sum(axis=(0, 1)) + direct * max(sun[2], 0.0)
    grey = 0.75 * light.mean() / np.pi * np.array([0.96, 1.0, 1.05])
    veil = (1.0 + 2.0 * np.sin(elevation))[:, None, None] / 3.0 * 1.28 * grey
    return Sky(
        radiance=((1.0 - overcast) * radiance + overcast * veil).astype(np.float32),
        sun_direction=sun,
        sun_irradiance=direct * (1.0 - overcast) ** 2,
        overcast=overcast,
    )


def harmonics(sky: Sky, below: Vector3) -> Harmonics:
    """Nine coefficients of the irradiance from all around, `below` being the radiance of the lower hemisphere.

    Source: Ramamoorthi and Hanrahan 2001, An efficient representation for irradiance environment maps, eq. (4)-(10).
    """
    rows, columns = sky.radiance.shape[:2]
    elevation, weight = _solid_angles(rows, columns)
    azimuth = 2.0 * np.pi * (np.arange(columns) + 0.5) / columns
    result = np.zeros((9, 3))
    for sign in (1.0, -1.0):
        x = np.cos(elevation)[:, None] * np.cos(azimuth)
        y = np.cos(elevation)[:, None] * np.sin(azimuth)
        z = np.broadcast_to(sign * np.sin(elevation)[:, None], x.shape)
        basis = _basis(x, y, z) * weight[:, None]
        light = sky.radiance if sign > 0.0 else np.broadcast_to(below, sky.radiance.shape)
        result += np.einsum("krc,rcj->kj", basis, light)
    bands = np.array([np.pi, *[2.0 * np.pi / 3.0] * 3, *[np.pi / 4.0] * 5])
    return result * bands[:, None]


def _basis(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    constant, linear = np.full_like(x, 0.282095), 0.488603
    quadratic = (1.092548 * x * y, 1.092548 * y * z, 0.315392 * (3.0 * z * z - 1.0), 1.092548 * x * z)
    return np.stack([constant, linear * y, linear * z, linear * x, *quadratic, 0.546274 * (x * x - y * y)])


def _solid_angles(rows: int, columns: int) -> tuple[np.ndarray, np.ndarray]:
    """Elevation of each row [rad] and the solid angle of a pixel in it [sr]."""
    edges = 0.5 * np.pi * (np.arange(rows + 1) / rows) ** 2
    elevation = 0.5 * np.pi * ((np.arange(rows) + 0.5) / rows) ** 2
    return elevation, np.diff(np.sin(edges)) * 2.0 * np.pi / columns


def _transmittance(sine: np.ndarray, height: np.ndarray | float = 0.0) -> np.ndarray:
    """Through the atmosphere at an elevation of this sine, from a height [m]; (..., 3)."""
    b = (EARTH_M + height) * sine
    path = -b + np.sqrt(b * b + TOP_M**2 + 2.0 * EARTH_M * TOP_M - 2.0 * EARTH_M * height - height**2)
    steps = (np.arange(10) + 0.5) / 10.0
    along = path[..., None] * steps**2
    width = path[..., None] * 2.0 * steps / 10.0
    h0 = np.broadcast_to(height, sine.shape)[..., None]
    altitude = np.sqrt((EARTH_M + h0) ** 2 + along**2 + 2.0 * along * b[..., None]) - EARTH_M
    altitude = np.maximum(altitude, 0.0)
    return np.exp(-_depth((np.exp(-altitude / 8e3) * width).sum(-1), (np.exp(-altitude / 1.2e3) * width).sum(-1)))


def _depth(rayleigh_m: np.ndarray, mie_m: np.ndarray) -> np.ndarray:
    return rayleigh_m[..., None] * (RAYLEIGH + OZONE) + 1.1 * MIE * mie_m[..., None]


def _scattered(elevation: np.ndarray, azimuth: np.ndarray, sun_elevation: float) -> np.ndarray:
    """Radiance from elevation x azimuth off the sun, scattered once, and a little for what is scattered again."""
    sine = np.sin(elevation)
    b = EARTH_M * sine
    path = -b + np.sqrt(b * b + TOP_M**2 + 2.0 * EARTH_M * TOP_M)
    steps = (np.arange(20) + 0.5) / 20.0
    along, width = path[:, None] * steps**2, path[:, None] * 2.0 * steps / 20.0
    altitude = np.sqrt(EARTH_M**2 + along**2 + 2.0 * along * b[:, None]) - EARTH_M
    rayleigh, mie = np.exp(-altitude / 8e3), np.exp(-altitude / 1.2e3)
    here = np.exp(-_depth(np.cumsum(rayleigh * width, 1), np.cumsum(mie * width, 1)))
    ambient = (
        AGAIN * _transmittance(np.sin(np.array([sun_elevation + 0.14])))[0] * (max(np.sin(sun_elevation), 0.0) + 0.1)
    )
    repeated = (rayleigh[..., None] * RAYLEIGH + (MIE * mie)[..., None]) * ambient
    result = np.zeros((len(elevation), len(azimuth), 3))
    for k, angle in enumerate(azimuth):
        cosine = np.sin(sun_elevation) * sine + np.cos(sun_elevation) * np.cos(elevation) * np.cos(angle)
        up = (EARTH_M * np.sin(sun_elevation) + along * cosine[:, None]) / (EARTH_M + altitude)
        sunlight = _transmittance(np.maximum(up, -0.06), altitude) * (up > -0.05)[..., None]
        g = MIE_FORWARD
        phase_r = 3.0 / (16.0 * np.pi) * (1.0 + cosine**2)
        phase_m = (1.0 - g * g) / (4.0 * np.pi * (1.0 + g * g - 2.0 * g * cosine) ** 1.5)
        source = phase_r[:, None, None] * rayleigh[..., None] * RAYLEIGH
        source = source + phase_m[:, None, None] * (MIE * mie)[..., None]
        result[:, k] = SUN * (here * (sunlight * source + repeated) * width[..., None]).sum(1)
    return result


def _whitened(clear: np.ndarray, elevation: np.ndarray, sun_elevation: float) -> np.ndarray:
    """Light scattered many times has no colour left: pale horizons while the sun is up."""
    share = 0.85 * np.exp(-elevation / 0.22) * np.clip(np.sin(sun_elevation) / 0.35, 0.0, 1.0)
    pale = clear.mean(axis=-1, keepdims=True) * np.array([0.95, 1.0, 1.07])
    return clear + share[:, None, None] * (pale - clear)


def _with_clouds(
    clear: np.ndarray,
    elevation: np.ndarray,
    azimuth: np.ndarray,
    sun: Vector3,
    direct: np.ndarray,
    cloud: float,
    rng: np.random.Generator,
) -> np.ndarray:
    """Fair-weather clouds on a level ceiling, thin towards the horizon."""
    tile = fractal_tile(512, 3.0, rng)
    reach = 1.0 / (np.tan(elevation) + 0.12)
    x, y = reach[:, None] * np.cos(azimuth), reach[:, None] * np.sin(azimuth)
    offset = rng.uniform(0.0, 1.0, 2)
    field = 0.65 * sample_tile(tile, 0.09 * x + offset[0], 0.09 * y + offset[1])
    field += 0.25 * sample_tile(tile, 0.31 * x + offset[1], 0.31 * y + offset[0])
    field += 0.10 * sample_tile(tile, 0.97 * x, 0.97 * y)
    level = float(np.quantile(field, 1.0 - np.clip(cloud, 0.0, 0.999))) if cloud > 0.0 else 2.0
    cover = np.clip((field - level) / 0.26, 0.0, 1.0)
    cover = cover * cover * (3.0 - 2.0 * cover) * np.clip(elevation / 0.10, 0.25, 0.95)[:, None]
    towards = np.cos(elevation)[:, None] * (np.cos(azimuth) * sun[0] + np.sin(azimuth) * sun[1])
    glow = 0.75 + 0.5 * np.clip(towards + np.sin(elevation)[:, None] * sun[2], 0.0, 1.0) ** 4
    lit = (0.55 * direct * np.clip(sun[2] + 0.15, 0.05, 1.0) / np.pi + 0.9 * clear.mean(axis=(0, 1))) * 1.15
    thick = 1.0 - 0.35 * np.clip((field - level) / 0.35, 0.0, 1.0)
    return clear * (1.0 - cover[..., None]) + cover[..., None] * (glow * thick)[..., None] * lit
