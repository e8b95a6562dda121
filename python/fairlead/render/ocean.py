# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The sea: waves of a spectrum in four tiles of different size and orientation, docs/rendering.md section 4.

Sources: Pierson and Moskowitz 1964 (spectrum); Tessendorf 2001, Simulating Ocean Water, eq. (26)-(29) (horizontal
displacement); Monahan and O'Muircheartaigh 1980 (whitecaps).
"""

from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from jaxtyping import Complex128, Float32, Float64

GRAVITY = 9.81
TILES_M = (1021.0, 211.0, 47.0, 9.7)
"""Side of each tile [m]: no small common multiple, so that no pattern repeats."""
TURNS_RAD = (0.0, 0.61, -0.43, 1.13)
"""Each tile is turned by this about the vertical, against visible rows."""
CHOP = 1.05
"""Horizontal displacement in units of that of a linear wave [-]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class WaveTile:
    """One tile at one time; row is y, column x, both in the tile's own turned axes."""

    side_m: float
    turn_rad: float
    slope: Float32[np.ndarray, "n n 2"]
    """dz/dx, dz/dy in world axes [-]."""
    displacement: Float32[np.ndarray, "n n 3"]
    """World axes [m]."""
    squeeze: Float32[np.ndarray, "n n"]
    """How much the surface is pressed together [-]: large where a wave breaks."""
    shortest_m: float
    """Shortest wave in it [m]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Waves:
    """The whole surface at one time."""

    tiles: tuple[WaveTile, ...]
    breaking: float
    """Sum of the tiles' squeeze above which there is foam [-]."""
    wind_m_s: float


@dataclass(frozen=True, kw_only=True, eq=False)
class _Spectrum:
    side_m: float
    turn_rad: float
    kx: Float64[np.ndarray, "n n"]
    ky: Float64[np.ndarray, "n n"]
    frequency: Float64[np.ndarray, "n n"]
    amplitude: Complex128[np.ndarray, "n n"]


class WaveField:
    """Waves of one wind for all times: the same seed gives the same sea.

    `wind_m_s` at 10 m height, blowing towards `direction_rad` from the world's x axis.
    """

    def __init__(self, wind_m_s: float, direction_rad: float, seed: int, size: int = 256) -> None:
        if not 0.5 <= wind_m_s <= 40.0:
            raise ValueError(f"wind: expected 0.5 to 40 m/s, got {wind_m_s}")
        rng = np.random.default_rng(seed)
        self._wind = wind_m_s
        limits = [0.0, *(6.0 * 2.0 * np.pi / side for side in TILES_M[1:]), np.inf]
        self._spectra = [
            _spectrum(side, turn, (limits[i], limits[i + 1]), wind_m_s, direction_rad, size, rng)
            for i, (side, turn) in enumerate(zip(TILES_M, TURNS_RAD, strict=True))
        ]

    def at(self, time_s: float) -> Waves:
        """The surface at a time."""
        tiles = tuple(_tile(spectrum, time_s) for spectrum in self._spectra)
        spread = float(np.sqrt(sum(float(tile.squeeze.var()) for tile in tiles)))
        coverage = min(0.2, 3.84e-6 * self._wind**3.41)
        return Waves(tiles=tiles, breaking=spread * NormalDist().inv_cdf(1.0 - coverage), wind_m_s=self._wind)


def _spectrum(
    side: float,
    turn: float,
    band: tuple[float, float],
    wind: float,
    direction: float,
    size: int,
    rng: np.random.Generator,
) -> _Spectrum:
    """Amplitudes of one tile, of the wave numbers in its band only."""
    wave = np.fft.fftfreq(size, 1.0 / size) * 2.0 * np.pi / side
    kx, ky = np.meshgrid(wave, wave)
    k = np.hypot(kx, ky)
    k[0, 0] = 1.0
    omega = np.sqrt(GRAVITY * k)
    peak = 0.855 * GRAVITY / wind
    density = 8.1e-3 * GRAVITY**2 / omega**5 * np.exp(-1.25 * (peak / omega) ** 4)
    along = np.cos(np.arctan2(ky, kx) + turn - direction)
    spreading = np.where(along > 0.0, along**4, 0.02 * along**2) * 8.0 / (3.0 * np.pi)
    by_wave_number = density * 0.5 * np.sqrt(GRAVITY / k) / k * spreading
    kept = (k >= band[0]) & (k < band[1]) & (k < 0.9 * np.pi * size / side)
    by_wave_number = np.where(kept, by_wave_number, 0.0)
    by_wave_number[0, 0] = 0.0
    phases = rng.standard_normal((size, size)) + 1j * rng.standard_normal((size, size))
    amplitude = np.sqrt(by_wave_number) * 2.0 * np.pi / side * phases * size**2
    return _Spectrum(side_m=side, turn_rad=turn, kx=kx, ky=ky, frequency=omega, amplitude=amplitude)


def _tile(spectrum: _Spectrum, time_s: float) -> WaveTile:
    """docs/rendering.md eq. (1): sums over the wave numbers by FFT; turned vectors come back in world axes."""
    H = spectrum.amplitude * np.exp(-1j * spectrum.frequency * time_s)
    k = np.hypot(spectrum.kx, spectrum.ky)
    k[0, 0] = 1.0
    height = np.fft.ifft2(H).real
    slope_x, slope_y = (np.fft.ifft2(1j * part * H).real for part in (spectrum.kx, spectrum.ky))
    shift_x, shift_y = (CHOP * np.fft.ifft2(1j * part / k * H).real for part in (spectrum.kx, spectrum.ky))
    squeeze = CHOP * np.fft.ifft2(k * H).real
    c, s = np.cos(spectrum.turn_rad), np.sin(spectrum.turn_rad)
    slope = np.stack([c * slope_x - s * slope_y, s * slope_x + c * slope_y], axis=-1)
    displacement = np.stack([c * shift_x - s * shift_y, s * shift_x + c * shift_y, height], axis=-1)
    return WaveTile(
        side_m=spectrum.side_m,
        turn_rad=spectrum.turn_rad,
        slope=slope.astype(np.float32),
        displacement=displacement.astype(np.float32),
        squeeze=squeeze.astype(np.float32),
        shortest_m=2.0 * spectrum.side_m / len(height),
    )
