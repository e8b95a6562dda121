# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A long flight round the target, one view at a time, so that its length does not matter."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from fairlead.simulate.errors import ModelError, ObservationError
from fairlead.simulate.trajectory import arc_centres, box_centre, look_at
from fairlead.simulate.truth import project_all, roughly_known
from fairlead.types import Camera, Points3, Poses, Target, View


@dataclass(frozen=True, kw_only=True)
class OrbitScenario:
    """Circles about the vertical axis through the target's origin at constant speed, from astern to port first."""

    frames: int = 20_000
    rate_hz: float = 25.0
    speed_m_s: float = 52.0
    range_m: float = 1000.0
    elevation_deg: float = 15.0
    model: ModelError = field(default_factory=ModelError)
    observation: ObservationError = field(default_factory=ObservationError)

    def poses(self, X_true: Points3, frames: np.ndarray) -> Poses:
        """True T_camera_target of these frames, (k, 4, 4)."""
        elevation = float(np.radians(self.elevation_deg))
        rate = self.speed_m_s / (self.range_m * np.cos(elevation))
        azimuths = np.pi - rate * frames / self.rate_hz
        return look_at(arc_centres(azimuths, self.range_m, elevation), box_centre(X_true))


def orbit_told(target: Target, scenario: OrbitScenario, rng: np.random.Generator) -> Target:
    """What is told of the true `target`: one draw of the rough model."""
    X0 = scenario.model.draw(target.positions, rng)
    return roughly_known(target, X0, scenario.model.told_covariance(X0))


def orbit_views(target: Target, camera: Camera, scenario: OrbitScenario, rng: np.random.Generator) -> Iterator[View]:
    """Views of the true `target` in order of time. Memory does not grow with the number of frames."""
    X_true = target.positions
    covariances = scenario.observation.told_covariances(len(X_true))
    batch = 250
    for start in range(0, scenario.frames, batch):
        frames = np.arange(start, min(start + batch, scenario.frames))
        T = scenario.poses(X_true, frames)
        pixels = scenario.observation.draw(project_all(camera, X_true, T), rng)
        for frame, z in zip(frames, pixels, strict=True):
            stamp_ns = round(int(frame) * 1e9 / scenario.rate_hz)
            yield View(
                frame=int(frame), stamp_ns=stamp_ns, landmarks=target.landmarks, pixels=z, covariances=covariances
            )
