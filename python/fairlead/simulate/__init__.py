# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Truth, and what the estimator is told: two records that are never mixed. No estimator in here."""

from fairlead.simulate.arc import ArcScenario, simulate_arc
from fairlead.simulate.camera_motion import Pointing, Shake
from fairlead.simulate.errors import ModelError, ObservationError
from fairlead.simulate.flight import simulate
from fairlead.simulate.frames import Frames
from fairlead.simulate.legs import Leg, Legs
from fairlead.simulate.mistakes import Outliers, Swaps
from fairlead.simulate.noise import Noise
from fairlead.simulate.orbit import OrbitScenario, orbit_told, orbit_views
from fairlead.simulate.paths import Approach, Arc, Helix, Orbit, Rendezvous
from fairlead.simulate.recorded import Recorded
from fairlead.simulate.scenario import Scenario
from fairlead.simulate.scenario_file import ScenarioFile, load_scenario, shipped_scenarios
from fairlead.simulate.sensors import AttitudeSensor, RangeFinder
from fairlead.simulate.target_motion import Shifting, TargetMotion, Turning
from fairlead.simulate.trajectory import arc_centres, look_at
from fairlead.simulate.truth import Simulation, project_all
from fairlead.simulate.visibility import Dropout, Occlusion

__all__ = [
    "Approach",
    "Arc",
    "ArcScenario",
    "AttitudeSensor",
    "Dropout",
    "Frames",
    "Helix",
    "Leg",
    "Legs",
    "ModelError",
    "Noise",
    "ObservationError",
    "Occlusion",
    "Orbit",
    "OrbitScenario",
    "Outliers",
    "Pointing",
    "RangeFinder",
    "Recorded",
    "Rendezvous",
    "Scenario",
    "ScenarioFile",
    "Shake",
    "Shifting",
    "Simulation",
    "Swaps",
    "TargetMotion",
    "Turning",
    "arc_centres",
    "load_scenario",
    "look_at",
    "orbit_told",
    "orbit_views",
    "project_all",
    "shipped_scenarios",
    "simulate",
    "simulate_arc",
]
