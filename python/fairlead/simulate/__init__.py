# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Truth, and what the estimator is told: two records that are never mixed. No estimator in here."""

from fairlead.simulate.arc import ArcScenario, simulate_arc
from fairlead.simulate.errors import ModelError, ObservationError
from fairlead.simulate.orbit import OrbitScenario, orbit_told, orbit_views
from fairlead.simulate.trajectory import arc_centres, look_at
from fairlead.simulate.truth import Simulation, project_all

__all__ = [
    "ArcScenario",
    "ModelError",
    "ObservationError",
    "OrbitScenario",
    "Simulation",
    "arc_centres",
    "look_at",
    "orbit_told",
    "orbit_views",
    "project_all",
    "simulate_arc",
]
