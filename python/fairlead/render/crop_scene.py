# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The world of a block of crops: a target of varied shape under one sky, on one sea, with what else swims there."""

from dataclasses import dataclass

import numpy as np

from fairlead import geometry
from fairlead.render.crop_clutter import Clutter
from fairlead.render.distractors import island, other_ship
from fairlead.render.ocean import WaveField, Waves
from fairlead.render.raster.model import Model
from fairlead.render.raster.renderer import Renderer
from fairlead.render.raster.vertices import Vertices, open_sky, pack, thickest_first
from fairlead.render.raycast import RayCaster
from fairlead.render.room import in_a_room
from fairlead.render.surface import Surface
from fairlead.render.surroundings import Kind, Surroundings, at_sea, in_space
from fairlead.render.variations import Warp, repainted
from fairlead.types import Matrix3, Matrix4, Points3, Target

SHIPS = 6
"""Other ships of a block."""
SKIES = ((0.0, 0.55), (0.35, 0.25), (1.0, 0.20))
"""Overcast and how often: clear, hazy, grey."""


@dataclass(frozen=True, kw_only=True, eq=False)
class CropScene:
    """What the crops of one block share."""

    caster: RayCaster
    X: Points3
    """Landmarks on the varied shape [m]."""
    surroundings: Surroundings
    waves: Waves | None


class Stage:
    """Sets one scene after another on one renderer."""

    def __init__(
        self, renderer: Renderer, target: Target, surface: Surface, kind: Kind, R_level_target: Matrix3
    ) -> None:
        surface, thickness = thickest_first(surface)
        self._renderer, self._target, self._surface, self._kind = renderer, target, surface, kind
        shares = open_sky(RayCaster(surface), np.random.default_rng(0))
        self._vertices: Vertices = pack(surface, shares)
        self.model = renderer.add(self._vertices, thickness)
        self._T_level_target = np.eye(4)
        self._waves: Waves | None = None
        self.painted = surface
        self._ships: list[Model] = []
        rng = np.random.default_rng(5)
        self._level = np.eye(4)
        self._level[:3, :3] = R_level_target
        self._room = Clutter(renderer, target, R_level_target, rng) if kind == "room" else None
        self._islands = [renderer.add(pack(island(rng))) for _ in range(2)] if kind == "sea" else []

    def set(self, rng: np.random.Generator) -> CropScene:
        """A new shape, sky and sea, and other ships."""
        warp = Warp(self._surface, rng)
        surface = self._surface.with_vertices(warp(self._surface.vertices))
        azimuth = float(rng.uniform(0.0, 2.0 * np.pi))
        if self._kind == "space":
            elevation = float(np.arcsin(rng.uniform(-1.0, 1.0)))
            surroundings = in_space(rng, sun_elevation_rad=elevation, sun_azimuth_rad=azimuth)
        elif self._kind == "room":
            surroundings = in_a_room(rng)
        else:
            surroundings = self._sea(surface, azimuth, rng)
            self._meet_others(rng)
        self._renderer.set_surroundings(surroundings)
        self._T_level_target = geometry.exp_se3(np.array([0.0, 0.0, 0.5, 0.03, 0.008, 0.0]) * rng.standard_normal(6))
        self._vertices[:, :3] = surface.vertices[surface.faces].reshape(-1, 3)
        self.painted = surface
        self.paint(rng)
        caster = RayCaster(surface)
        return CropScene(caster=caster, X=warp(self._target.positions), surroundings=surroundings, waves=self._waves)

    def _sea(self, surface: Surface, azimuth: float, rng: np.random.Generator) -> Surroundings:
        overcast = rng.choice([sky[0] for sky in SKIES], p=[sky[1] for sky in SKIES])
        surroundings = at_sea(
            surface,
            rng,
            sun_elevation_rad=float(np.radians(rng.uniform(3.0, 70.0))),
            sun_azimuth_rad=azimuth,
            cloud=float(rng.uniform(0.0, 0.7)),
            overcast=float(np.clip(overcast + rng.uniform(-0.1, 0.1), 0.0, 1.0)),
            wind_m_s=float(rng.uniform(2.0, 15.0)),
            speed_m_s=float(rng.choice([0.0, rng.uniform(3.0, 14.0)], p=[0.15, 0.85])),
            weathering=float(rng.uniform(0.0, 1.0)),
        )
        waves = WaveField(surroundings.wind_m_s, float(rng.uniform(0.0, 2.0 * np.pi)), int(rng.integers(2**31)))
        self._waves = waves.at(float(rng.uniform(0.0, 100.0)))
        self._renderer.set_waves(self._waves)
        return surroundings

    def _meet_others(self, rng: np.random.Generator) -> None:
        for ship in self._ships:
            ship.release()
        self._ships = [self._renderer.add(pack(other_ship(rng))) for _ in range(SHIPS)]

    def paint(self, rng: np.random.Generator) -> None:
        """Other colours on the same shape."""
        painted = self._surface.with_materials(repainted(self._surface, rng))
        self.painted = self.painted.with_materials(painted.materials)
        self._vertices[:, 6:9] = np.repeat(painted.colours, 3, axis=0)
        self._vertices[:, 9] = np.repeat(painted.roughness, 3)
        self.model.repaint(self._vertices)

    def place(self, rng: np.random.Generator) -> Matrix4:
        """T_world_target: somewhere on the sea, with the roll and heave of the block."""
        if self._kind == "space":
            return np.eye(4)
        if self._room is not None:
            tilt = np.array([0.0, 0.0, 0.0, *(0.3 * rng.standard_normal(2)), rng.uniform(0.0, 2.0 * np.pi)])
            return geometry.exp_se3(tilt) @ self._level
        T = self._T_level_target.copy()
        T[:2, 3] += rng.uniform(-5000.0, 5000.0, 2)
        return T

    def others(self, T_world_target: Matrix4, rng: np.random.Generator) -> list[tuple[Model, Matrix4]]:
        """Ships near the target in one crop of three, land in one of seven; never in its place."""
        if self._room is not None:
            return self._room.about(T_world_target, rng)
        found: list[tuple[Model, Matrix4]] = []
        if not self._ships:
            return found
        for chance, models, near, far in ((0.33, self._ships, 350.0, 2500.0), (0.15, self._islands, 4500.0, 9000.0)):
            if rng.random() < chance:
                for _ in range(int(rng.integers(1, 3))):
                    T = geometry.exp_se3(np.array([0.0, 0.0, 0.0, 0.0, 0.0, rng.uniform(0.0, 2.0 * np.pi)]))
                    a, r = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(near, far)
                    T[:2, 3] = T_world_target[:2, 3] + r * np.array([np.cos(a), np.sin(a)])
                    found.append((models[int(rng.integers(len(models)))], T))
        return found

    def stand_in(self, rng: np.random.Generator) -> Model | None:
        """Another ship for the target's place, three times in four."""
        if not self._ships or rng.random() < 0.25:
            return None
        return self._ships[int(rng.integers(len(self._ships)))]
