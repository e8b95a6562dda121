# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Drops and flakes that fall through the view: a box of them round the camera that moves with the wind and repeats."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Float32

from fairlead import geometry
from fairlead.opencv.filters import streaks
from fairlead.types import Camera, Matrix4

BOX_M = 14.0


@dataclass(frozen=True, kw_only=True)
class Flakes:
    """What falls."""

    count: int
    """In a box of BOX_M."""
    size_m: float
    fall_m_s: float
    drift_m_s: float
    """With the wind, along the world's x."""
    sway_m: float
    """Amplitude of a flake's own wandering."""


@lru_cache(maxsize=4)
def _drawn(count: int, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Where each starts, phase and rate of its wandering, its share of the common speed."""
    rng = np.random.default_rng([seed, 17])
    start = rng.uniform(0.0, BOX_M, (count, 3))
    phase, rate = rng.uniform(0.0, 2 * np.pi, (count, 2)), rng.uniform(1.0, 3.0, (count, 2))
    return start, phase, rate, rng.uniform(0.8, 1.2, count)


def falling(
    flakes: Flakes, camera: Camera, T_camera_world: Matrix4, time_s: float, exposure_s: float, seed: int
) -> Float32[np.ndarray, "h w"]:
    """How much of each pixel they cover [0..1]: each drawn as the line it moves along while the shutter is open."""
    start, phase, rate, speed = _drawn(flakes.count, seed)
    eye = -T_camera_world[:3, :3].T @ T_camera_world[:3, 3]

    def places(t: float) -> np.ndarray:
        velocity = np.column_stack(
            [np.full(flakes.count, flakes.drift_m_s), np.zeros(flakes.count), -flakes.fall_m_s * speed]
        )
        moved = start + velocity * t
        if flakes.sway_m > 0.0:
            moved[:, :2] += flakes.sway_m * np.sin(rate * t + phase)
        return moved

    now = places(time_s)
    offset = (now - eye) % BOX_M - 0.5 * BOX_M  # the copy nearest to the camera
    before = offset + places(time_s - exposure_s) - now
    R = T_camera_world[:3, :3]
    ends, starts = offset @ R.T, before @ R.T
    seen = (ends[:, 2] > 0.4) & (starts[:, 2] > 0.4)
    last, first = geometry.project(camera, ends[seen]), geometry.project(camera, starts[seen])
    size_px = camera.K[0, 0] * flakes.size_m / ends[seen, 2]
    length_px = np.linalg.norm(last - first, axis=1)
    # A drop that is thinner than a pixel, or that sweeps over many, covers each of them for a part of the time.
    cover = np.clip(np.minimum(size_px, 1.0) * np.clip(6.0 * size_px / (length_px + size_px), 0.15, 1.0), 0.0, 0.9)
    order = np.argsort(cover)
    size = np.array([camera.width, camera.height])
    inside = (np.abs(last - 0.5 * size) / size).max(axis=1) < 1.5
    order = order[inside[order]]
    widths = np.clip(size_px, 1.0, 0.03 * camera.width)
    return streaks((camera.height, camera.width), first[order], last[order], widths[order], cover[order])
