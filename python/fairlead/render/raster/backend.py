# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Sequences at draft quality."""

import numpy as np

from fairlead.render.flights import Placed
from fairlead.render.images import LinearImage, TruthImage
from fairlead.render.job import Job
from fairlead.render.ocean import WaveField
from fairlead.render.raster.model import Shot
from fairlead.render.raster.renderer import Renderer
from fairlead.render.raster.vertices import open_sky, pack, thickest_first
from fairlead.render.raycast import RayCaster


class RasterBackend:
    """The rasteriser, frame by frame."""

    def __init__(self, job: Job) -> None:
        surface, thickness = thickest_first(job.surface())
        self._camera = job.camera
        self._renderer = Renderer(job.camera.width, job.camera.height)
        shares = open_sky(RayCaster(surface), np.random.default_rng(0))
        self._model = self._renderer.add(pack(surface, shares), thickness)
        self._renderer.set_surroundings(job.surrounded(surface))
        s = job.setting
        at_sea = s.surroundings == "sea"
        self._waves = WaveField(s.wind_m_s, float(np.radians(s.wind_azimuth_deg)), job.seed) if at_sea else None

    def render(self, placed: Placed) -> tuple[LinearImage, TruthImage]:
        """One frame."""
        if self._waves is not None:
            self._renderer.set_waves(self._waves.at(placed.stamp_ns * 1e-9))
        shot = Shot(camera=self._camera, T_camera_target=placed.T_camera_target, T_world_target=placed.T_world_target)
        return self._renderer.draw(shot, self._model), self._renderer.truth(shot, self._model)
