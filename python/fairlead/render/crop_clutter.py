# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Clutter about the target of a crop in a room."""

from collections.abc import Callable

import numpy as np

from fairlead import geometry
from fairlead.render.clutter import false_tag, hand, thing
from fairlead.render.raster.model import Model
from fairlead.render.raster.renderer import Renderer
from fairlead.render.raster.vertices import pack
from fairlead.render.surface import Surface
from fairlead.types import Matrix3, Matrix4, Target, Vector3


class Clutter:
    """Things of the size of the target and larger, made once; for each crop some of them are laid about it."""

    def __init__(self, renderer: Renderer, target: Target, R_level_target: Matrix3, rng: np.random.Generator) -> None:
        low, high = target.positions.min(axis=0), target.positions.max(axis=0)
        self._size = float(np.linalg.norm(high - low))
        self._T_target_middle = np.eye(4)
        self._T_target_middle[:3, :3] = R_level_target.T
        self._T_target_middle[:3, 3] = 0.5 * (low + high)

        def made(make: Callable[[np.random.Generator], Surface], count: int, least: float, most: float) -> list[Model]:
            scales = self._size * np.exp(rng.uniform(np.log(least), np.log(most), count))
            surfaces = [(make(rng), scale) for scale in scales]
            return [renderer.add(pack(each.with_vertices(each.vertices * scale))) for each, scale in surfaces]

        self._things, self._tags = made(thing, 24, 0.2, 2.5), made(false_tag, 6, 0.2, 0.6)
        self._hands = made(hand, 6, 0.7, 1.2)

    def about(self, T_world_target: Matrix4, rng: np.random.Generator) -> list[tuple[Model, Matrix4]]:
        """Up to five things, now and then a false tag, and in two crops of three a hand that holds it from above."""
        T_world_middle = T_world_target @ self._T_target_middle
        chosen = [self._things[int(k)] for k in rng.integers(0, len(self._things), int(rng.integers(0, 6)))]
        if rng.random() < 0.3:
            chosen.append(self._tags[int(rng.integers(len(self._tags)))])
        found: list[tuple[Model, Matrix4]] = []
        for model in chosen:
            away = rng.standard_normal(3)
            away *= (model.radius + self._size * rng.uniform(0.6, 5.0)) / np.linalg.norm(away)
            found.append((model, T_world_middle @ _placed(np.pi * rng.standard_normal(3), away)))
        if rng.random() < 2.0 / 3.0:
            turn = np.array([*(0.3 * rng.standard_normal(2)), rng.uniform(0.0, 2.0 * np.pi)])
            above = self._size * np.array([*(0.1 * rng.standard_normal(2)), rng.uniform(0.45, 1.2)])
            found.append((self._hands[int(rng.integers(len(self._hands)))], T_world_middle @ _placed(turn, above)))
        return found


def _placed(phi: Vector3, origin: Vector3) -> Matrix4:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = geometry.exp_so3(phi), origin
    return T
