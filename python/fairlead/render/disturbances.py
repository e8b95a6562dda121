# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What happens to a training crop between light and file: things in the way, motion blur, colour, compression."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32

from fairlead.render.images import Radiance
from fairlead.render.sensor import Sensor, exposure_for

Cover = Float32[np.ndarray, "h w"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Obstacle:
    """Something out of focus before the target: how much of each pixel it covers, and its radiance."""

    cover: Cover
    radiance: np.ndarray
    """(3,)."""

    def over(self, radiance: Radiance) -> Radiance:
        """The light with the obstacle in front."""
        cover = self.cover[..., None]
        return (radiance * (1.0 - cover) + cover * self.radiance).astype(np.float32)


def draw_obstacle(size: int, level: float, rng: np.random.Generator) -> Obstacle:
    """A turned box or ellipse with soft edges, anywhere; brightness from black to white."""
    centre = rng.uniform(0.0, size, 2)
    half = size * np.exp(rng.uniform(np.log(0.03), np.log(0.3), 2))
    angle = rng.uniform(0.0, np.pi)
    soft = rng.uniform(0.5, 6.0)
    y, x = np.mgrid[:size, :size].astype(np.float32)
    c, s = np.cos(angle), np.sin(angle)
    u, v = (c * (x - centre[0]) + s * (y - centre[1])), (-s * (x - centre[0]) + c * (y - centre[1]))
    if rng.random() < 0.5:
        off = (np.hypot(u / half[0], v / half[1]) - 1.0) * half.min()
    else:
        off = np.maximum(np.abs(u) - half[0], np.abs(v) - half[1])
    cover = np.clip(0.5 - off / soft, 0.0, 1.0) * rng.uniform(0.6, 1.0)
    colour = level * rng.uniform(0.0, 1.0) * np.exp(0.15 * rng.standard_normal(3))
    return Obstacle(cover=cover.astype(np.float32), radiance=colour.astype(np.float32))


def smeared(radiance: Radiance, rng: np.random.Generator) -> Radiance:
    """Motion while the shutter was open: a straight line of up to 5 px, about its middle."""
    length, angle = rng.uniform(1.0, 5.0), rng.uniform(0.0, np.pi)
    steps = np.unique(np.round(np.linspace(-0.5, 0.5, 7)[:, None] * length * [np.cos(angle), np.sin(angle)]), axis=0)
    total = np.zeros_like(radiance)
    height, width = radiance.shape[:2]
    for dx, dy in steps.astype(int).tolist():
        rows, columns = np.clip(np.arange(height) + dy, 0, height - 1), np.clip(np.arange(width) + dx, 0, width - 1)
        total += radiance[rows][:, columns]
    return total / np.float32(len(steps))


def draw_sensor(level_irradiance: float, rng: np.random.Generator) -> Sensor:
    """Exposure within a stop or so, any sharpness, any noise."""
    return Sensor(
        exposure=exposure_for(level_irradiance) * float(np.exp(0.35 * rng.standard_normal())),
        blur_px=float(rng.uniform(0.2, 1.0)),
        full_well=float(np.exp(rng.uniform(np.log(600.0), np.log(12_000.0)))),
        read_noise=float(rng.uniform(2.0, 12.0)),
        vignetting=float(rng.uniform(0.0, 0.2)),
        bloom=float(rng.uniform(0.0, 0.05)),
    )


def tinted(radiance: Radiance, rng: np.random.Generator) -> Radiance:
    """White balance off by some percent; one picture in twenty without colour."""
    light = radiance * np.exp(0.06 * rng.standard_normal(3)).astype(np.float32)
    if rng.random() < 0.05:
        light = np.repeat(light.mean(axis=2, keepdims=True), 3, axis=2)
    return light.astype(np.float32)
