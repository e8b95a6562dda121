# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Foam and waves of a moving hull, in axes that move with it: x forward, y to port. docs/rendering.md section 4.

Two maps: a fine one about the hull, a coarse one of the long trail. Both renderers look them up, so there is one wake.
Source of the wave pattern: Newman 1977, Marine Hydrodynamics, section 6.10 (superposition of free waves, Kelvin).
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32

from fairlead.render.ocean import GRAVITY

WakeImage = Float32[np.ndarray, "r c 3"]


@dataclass(frozen=True, kw_only=True, eq=False)
class WakeMap:
    """Foam [0..1] and slopes dz/dx, dz/dy on a grid; row is y, column x; zero outside."""

    image: WakeImage
    x: tuple[float, float]
    """Of the outer edges of the first and last column [m]."""
    y: tuple[float, float]

    def sample(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Bilinear values (..., 3), zero outside."""
        rows, columns = self.image.shape[:2]
        u = (x - self.x[0]) / (self.x[1] - self.x[0]) * columns - 0.5
        v = (y - self.y[0]) / (self.y[1] - self.y[0]) * rows - 0.5
        i, j = np.floor(u).astype(int), np.floor(v).astype(int)
        total = np.zeros((*np.shape(x), 3))
        for dj in (0, 1):
            for di in (0, 1):
                inside = (i + di >= 0) & (i + di < columns) & (j + dj >= 0) & (j + dj < rows)
                weight = (1.0 - np.abs(u - i - di)) * (1.0 - np.abs(v - j - dj)) * inside
                values = self.image[np.clip(j + dj, 0, rows - 1), np.clip(i + di, 0, columns - 1)]
                total += weight[..., None] * values
        return total


@dataclass(frozen=True, kw_only=True)
class Hull:
    """The waterline's box [m]; `stern` and `bow` are x."""

    stern: float
    bow: float
    beam: float

    @property
    def length(self) -> float:
        """Of the waterline [m]."""
        return self.bow - self.stern


def make_wake(hull: Hull, speed_m_s: float) -> tuple[WakeMap, WakeMap]:
    """The fine and the coarse map of a hull at constant speed. No wake at all below 0.5 m/s."""
    L = hull.length
    near = _map(hull, speed_m_s, (hull.stern - 0.6 * L, hull.bow + 0.15 * L), (-0.35 * L, 0.35 * L), (768, 384))
    far = _map(hull, speed_m_s, (hull.stern - 14.0 * L, hull.bow + 0.5 * L), (-2.6 * L, 2.6 * L), (1024, 384))
    return near, far


def _map(hull: Hull, speed: float, x: tuple[float, float], y: tuple[float, float], size: tuple[int, int]) -> WakeMap:
    columns, rows = size
    xs = x[0] + (np.arange(columns) + 0.5) * (x[1] - x[0]) / columns
    ys = y[0] + (np.arange(rows) + 0.5) * (y[1] - y[0]) / rows
    X, Y = np.meshgrid(xs, ys)
    if speed < 0.5:
        return WakeMap(image=np.zeros((rows, columns, 3), np.float32), x=x, y=y)
    foam = _foam(hull, speed, X, np.abs(Y))
    half = _height(hull, speed, xs, ys[rows // 2 :])
    height = np.concatenate([half[::-1], half])
    slope_y, slope_x = np.gradient(height, ys, xs)
    image = np.stack([foam, slope_x, slope_y], axis=-1)
    edge = np.minimum.reduce([X - x[0], x[1] - X, Y - y[0], y[1] - Y]) / (0.06 * hull.length)
    return WakeMap(image=(image * np.clip(edge, 0.0, 1.0)[..., None]).astype(np.float32), x=x, y=y)


def half_breadth_at(hull: Hull, x: np.ndarray) -> np.ndarray:
    """A waterline that closes at the bow like a ship's [m]."""
    share = np.clip((x - hull.stern) / hull.length, 0.0, 1.0)
    return 0.47 * hull.beam * (1.0 - np.clip((share - 0.45) / 0.55, 0.0, 1.0) ** 1.6)


def _foam(hull: Hull, speed: float, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Coverage: bow wave, water along the sides, trail behind the propellers, arms that spread from the bow."""
    L, B = hull.length, hull.beam
    strength = float(np.clip(speed / 9.0, 0.2, 1.3))
    off = y - half_breadth_at(hull, x)
    share = (x - hull.stern) / L
    beside = (share > 0.0) & (share < 1.0)
    side = (
        np.exp(-((np.clip(off, 0.0, None) / (0.10 * B)) ** 2)) * beside * (0.35 + 0.45 * np.clip(share, 0.0, 1.0) ** 2)
    )
    bow = np.exp(-(((off - 0.05 * B) / (0.16 * B)) ** 2)) * np.exp(-(((share - 0.90) / 0.10) ** 2))
    behind_bow = np.clip(hull.bow - x, 0.0, None)
    arm = y - (0.22 * behind_bow + 0.02 * B)
    arms = (
        np.exp(-((arm / (0.07 * B + 0.035 * behind_bow)) ** 2)) * np.exp(-behind_bow / (0.9 * L)) * (behind_bow > 0.0)
    )
    astern = hull.stern - x
    far = np.clip(astern, 0.0, None)
    width = 0.40 * B + 0.045 * far
    begin = np.clip((astern + 0.03 * L) / (0.04 * L), 0.0, 1.0)
    core = np.exp(-((y / width) ** 4)) * begin * (0.12 + 0.83 * np.exp(-far / (1.1 * L)))
    edges = 0.5 * np.exp(-(((y - width) / (0.15 * B + 0.01 * far)) ** 2)) * begin * np.exp(-far / (3.5 * L))
    return np.clip(strength * np.maximum.reduce([side, 1.05 * bow, 0.75 * arms, core, edges]), 0.0, 1.0)


def _height(hull: Hull, speed: float, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Free waves behind a bow and a stern source, docs/rendering.md eq. (2); (rows, columns) for y >= 0 [m]."""
    number = GRAVITY / speed**2
    total = np.zeros((len(y), len(x)))
    angles = np.linspace(-1.25, 1.25, 361)
    k = number / np.cos(angles) ** 2
    amplitude = (0.35 + np.sin(angles) ** 2) * np.cos(angles) * np.exp(-(angles**6)) * np.exp(-k / (2.2 * number + 0.5))
    across = np.exp(1j * np.outer(y, k * np.sin(angles)))
    for source, sign in ((hull.bow - 0.06 * hull.length, 1.0), (hull.stern + 0.03 * hull.length, -0.7)):
        back = source - x
        along = amplitude[:, None] * np.exp(1j * np.outer(k * np.cos(angles), back))
        waves = (across @ along).real
        wedge = np.clip((0.42 * back[None, :] + 2.0 - y[:, None]) / (0.05 * np.abs(back[None, :]) + 4.0), 0.0, 1.0)
        total += sign * waves * wedge * np.clip(back / 10.0, 0.0, 1.0)[None, :]
    decay = np.exp(-np.clip(hull.stern - x, 0.0, None) / (8.0 * hull.length))
    peak = float(np.abs(total).max()) or 1.0
    return 0.016 * speed**2 / GRAVITY * 9.0 * total / peak * decay[None, :]
