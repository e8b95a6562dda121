# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A camera that hovers learns nothing new from a detector whose errors stay while the view stays."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fairlead.simulate import Noise, simulate
from fairlead.simulate.scenario_file import load_scenario
from fairlead.simulate.target_motion import TargetMotion
from fairlead.simulate.visibility import Occlusion
from fairlead.tracker import Tracker, TrackerOptions

pytestmark = pytest.mark.slow

ANGLE_DEG, LOG_RANGE, FLIGHTS = 12.0, 1.5, 8


@pytest.fixture(scope="module")
def flights(repository: Path):
    """600 m behind the frigate down to 400 m, then 30 s of hover, ten images a second, still ship."""
    scenario = load_scenario(repository / "data/scenarios/landing.toml").scenario
    scenario = replace(
        scenario,
        trajectory=replace(scenario.trajectory, hover_m=(-400.0, 0.0, 60.0), hover_s=30.0),
        frames=replace(scenario.frames, rate_hz=10.0),
        noise=Noise(sigma_px=1.5, correlation_angle_deg=ANGLE_DEG, correlation_log_range=LOG_RANGE),
        occlusion=Occlusion(),
        target_motion=TargetMotion(),
    )
    return [simulate(scenario, seed) for seed in range(FLIGHTS)]


def model_nees(flights, options: TrackerOptions) -> np.ndarray:
    """Per degree of freedom, at the end of each flight."""
    found = []
    for flight in flights:
        tracker = Tracker(replace(flight.target_told, motion=None), flight.camera, options)
        for view in flight.views:
            tracker.update(view)
        error = (tracker.model.positions - flight.target_true.positions).ravel()
        found.append(error @ np.linalg.solve(tracker.model.covariance, error) / len(error))
    return np.array(found)


def test_the_model_stays_honest_through_a_hover(flights):
    """NEES per degree of freedom below 1.5 plus three standard errors; told a time, it grows with the hover."""
    angle = TrackerOptions(correlation_angle_rad=float(np.radians(ANGLE_DEG)), correlation_log_range=LOG_RANGE)
    nees = model_nees(flights, angle)
    assert nees.mean() < 1.5 + 3.0 * nees.std(ddof=1) / np.sqrt(FLIGHTS)
    assert model_nees(flights, TrackerOptions(correlation_time_s=8.0)).mean() > 2.0 * nees.mean()
