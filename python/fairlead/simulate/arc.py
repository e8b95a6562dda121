# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The published simulation: a camera on an arc about the ship's stern, range 1 km (experiment 1 of Guo et al. 2024)."""

from dataclasses import dataclass, field

import numpy as np

from fairlead.simulate.errors import ModelError, ObservationError
from fairlead.simulate.trajectory import arc_centres, box_centre, look_at
from fairlead.simulate.truth import Simulation, known_exactly, project_all, roughly_known
from fairlead.types import Camera, Points3, Poses, Target, View


@dataclass(frozen=True, kw_only=True)
class ArcScenario:
    """A camera on an arc about the vertical axis through the target's origin, looking at the target's middle.

    Azimuths are pi - angle / 2 ... pi + angle / 2 in equal steps: the arc is symmetric about dead astern, from where a
    landing aircraft comes. (The publication leaves open where its arc starts.) The camera looks at the middle of the
    true landmarks.
    """

    angle_deg: float = 90.0
    """Rendezvous angle: what the arc covers [deg]."""
    views: int = 10
    range_m: float = 1000.0
    """From the target's origin [m]."""
    elevation_deg: float = 15.0
    """Of the camera above the water, seen from the origin [deg]."""
    interval_s: float = 3.0
    """Between views [s]; 30 s for a quarter circle at 52 m/s."""
    model: ModelError = field(default_factory=ModelError)
    observation: ObservationError = field(default_factory=ObservationError)

    def __post_init__(self) -> None:
        if self.views < 1 or not (0.0 <= self.angle_deg <= 360.0 and self.range_m > 0.0 and self.interval_s > 0.0):
            raise ValueError(
                f"arc: expected at least one view, 0..360 degrees, a positive range and interval, got {self}"
            )

    def poses(self, X_true: Points3) -> Poses:
        """True T_camera_target of every view, (k, 4, 4)."""
        half = 0.5 * np.radians(self.angle_deg)
        azimuths = np.pi + np.linspace(-half, half, self.views)
        centres = arc_centres(azimuths, self.range_m, float(np.radians(self.elevation_deg)))
        return look_at(centres, box_centre(X_true))


def simulate_arc(target: Target, camera: Camera, scenario: ArcScenario, rng: np.random.Generator) -> Simulation:
    """Draw one flight: a rough model about the true `target`, observations of all true landmarks in all views.

    All draws come from one stream: the recorded numbers of the benchmarks rest on them. `simulate` flies the same arc
    with a stream per effect (scenario `arc`, docs/simulate.md).

    Parameters
    ----------
    target : its positions are the truth; its covariance is replaced by what the scenario tells
    camera : landmarks outside the image are observed all the same
    scenario : geometry and errors
    rng : the only source of randomness; same state, same flight. Scenarios that differ in what is told of the errors,
        or in the outliers, but not in the rest, have the same model error and the same noise.
    """
    X = target.positions
    X0 = scenario.model.draw(X, rng)
    T = scenario.poses(X)
    pixels = scenario.observation.draw(project_all(camera, X, T), rng)
    covariances = scenario.observation.told_covariances(len(X))
    interval_ns = round(scenario.interval_s * 1e9)
    views = tuple(
        View(frame=k, stamp_ns=k * interval_ns, landmarks=target.landmarks, pixels=z, covariances=covariances)
        for k, z in enumerate(pixels)
    )
    return Simulation(
        camera=camera,
        target_told=roughly_known(target, X0, scenario.model.told_covariance(X0)),
        views=views,
        target_true=known_exactly(target),
        T_true=T,
    )
