# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Sequences at full quality. docs/rendering.md section 9."""

import numpy as np

from fairlead.render.cycles.tracer import Tracer
from fairlead.render.flights import Placed
from fairlead.render.images import LinearImage, TruthImage
from fairlead.render.job import Job
from fairlead.render.ocean import WaveField
from fairlead.render.raster.model import Shot
from fairlead.render.raster.renderer import Renderer
from fairlead.render.raster.vertices import open_sky, pack
from fairlead.render.raycast import RayCaster


class CyclesBackend:
    """The tracer, frame by frame."""

    def __init__(self, job: Job) -> None:
        self._job = job
        surface = job.surface()
        surroundings = job.surrounded(surface, fine_sky=True)
        self._renderer = Renderer(job.camera.width, job.camera.height)
        model = self._renderer.add(pack(surface, open_sky(RayCaster(surface), np.random.default_rng(0))))
        self._renderer.set_surroundings(surroundings)
        self._tracer = Tracer(self._renderer, model, surface, surroundings, job.samples, job.threads)
        s = job.setting
        at_sea = s.surroundings == "sea"
        self._waves = WaveField(s.wind_m_s, float(np.radians(s.wind_azimuth_deg)), job.seed) if at_sea else None

    def render(self, placed: Placed) -> tuple[LinearImage, TruthImage]:
        """One frame; the same frame gives the same light."""
        shot = Shot(
            camera=self._job.camera, T_camera_target=placed.T_camera_target, T_world_target=placed.T_world_target
        )
        waves = None if self._waves is None else self._waves.at(placed.stamp_ns * 1e-9)
        if waves is not None:
            self._renderer.set_waves(waves)
        return self._tracer.render(shot, waves, self._job.seed * 7919 + placed.frame)
