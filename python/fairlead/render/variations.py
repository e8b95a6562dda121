# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The same target a little different: shape and paint. Landmarks move with the shape."""

from dataclasses import replace

import numpy as np

from fairlead.render.surface import Material, Surface
from fairlead.types import Points3


class Warp:
    """A smooth change of shape: each axis by a few percent, and one slow bend. `amount` 0 leaves all as it is."""

    def __init__(self, surface: Surface, rng: np.random.Generator, amount: float = 0.04) -> None:
        self._low, high = surface.corners
        self._size = high - self._low
        self._scale = 1.0 + amount * rng.standard_normal(3)
        self._bend = 0.5 * amount * rng.standard_normal((3, 3))
        self._phase = rng.uniform(0.0, 2.0 * np.pi, (3, 3))

    def __call__(self, points: Points3) -> Points3:
        """Where the points go; z = 0 stays, so that a ship goes on floating."""
        share = (points - self._low) / self._size
        waves = np.sin(2.0 * np.pi * share[:, None, :] * 0.8 + self._phase) * self._bend
        about = np.array([0.5 * (2.0 * self._low[0] + self._size[0]), 0.0, 0.0])
        return about + (points - about) * self._scale * (1.0 + 0.5 * waves.sum(axis=2))


def repainted(surface: Surface, rng: np.random.Generator) -> tuple[Material, ...]:
    """Every material a little lighter or darker and of another hue; one common change, and one of its own each.

    Paint that is neither bright nor dark (hulls) changes most.
    """
    common, tint = np.exp(0.35 * rng.standard_normal()), np.exp(0.08 * rng.standard_normal(3))
    result: list[Material] = []
    for material in surface.materials:
        own = np.exp(0.12 * rng.standard_normal() + 0.04 * rng.standard_normal(3))
        colour = np.clip(np.array(material.colour) * common * tint * own, 0.004, 0.9)
        r, g, b = colour.tolist()
        rough = float(np.clip(material.roughness + 0.1 * rng.standard_normal(), 0.05, 1.0))
        result.append(replace(material, colour=(r, g, b), roughness=rough))
    return tuple(result)
