# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The typed wrappers of the core: what they hand on, and what they return."""

from dataclasses import replace

import numpy as np
import pytest

from fairlead.simulate import ArcScenario, ModelError, ObservationError, Simulation, simulate_arc
from fairlead.tracker import Tracker, TrackerOptions, refine
from fairlead.types import AttitudeReading, KnownDistance, MotionPrior, RangeReading

FRIGATE = ArcScenario(
    angle_deg=6.0,
    views=40,
    interval_s=0.04,
    model=ModelError(sigma_m=0.5),
    observation=ObservationError(sigma_px=1.0),
)


@pytest.fixture(scope="module")
def flight() -> Simulation:
    from benchmarks.cells import frigate

    target, camera = frigate()
    return simulate_arc(target, camera, FRIGATE, np.random.default_rng(5))


def test_a_prediction_is_an_estimate_of_no_image(flight: Simulation) -> None:
    tracker = Tracker(flight.target_told, flight.camera)
    assert not tracker.predict(0).ok
    for view in flight.views[:20]:
        last = tracker.update(view)
    ahead = tracker.predict(last.stamp_ns + 40_000_000)
    assert ahead.frame == -1
    assert ahead.status == "coasting"
    assert np.trace(ahead.covariance) > np.trace(last.covariance)
    assert tracker.predict(last.stamp_ns - 1).reason == "stamp"
    assert not tracker.predict(last.stamp_ns + 600_000_000).ok
    again = Tracker(flight.target_told, flight.camera)
    for view in flight.views[:20]:
        again.predict(view.stamp_ns)
        np.testing.assert_array_equal(again.update(view).T_camera_target.shape, (4, 4))
    np.testing.assert_array_equal(again.model.positions, tracker.model.positions)


def test_a_batch_takes_distances_ranges_attitudes_and_motion(flight: Simulation) -> None:

    X = flight.X_true
    names = flight.target_told.landmarks
    length = float(np.linalg.norm(X[0] - X[5]))
    bar = KnownDistance(between=(names[0], names[5]), length_m=length, sigma_m=0.01)
    known = replace(flight.target_told, distances=(bar,))
    found = refine(flight.views, known, flight.camera).model.positions
    assert abs(np.linalg.norm(found[0] - found[5]) - length) < 0.05

    ranges = [
        RangeReading(stamp_ns=view.stamp_ns, range_m=float(np.linalg.norm(T[:3, 3])), sigma_m=0.2)
        for view, T in zip(flight.views, flight.T_true, strict=True)
    ]
    attitudes = [
        AttitudeReading(stamp_ns=view.stamp_ns, R_world_camera=T[:3, :3].T, sigma_rad=1e-3)
        for view, T in zip(flight.views, flight.T_true, strict=True)
    ]
    options = TrackerOptions(motion="world")
    batch = refine(flight.views, flight.target_told, flight.camera, options, ranges=ranges, attitudes=attitudes)
    assert batch.ranges_believed == len(ranges)
    assert batch.model.positions.shape == X.shape
    errors = [
        np.linalg.norm(e.T_camera_target[:3, 3]) - r.range_m for e, r in zip(batch.estimates, ranges, strict=True)
    ]
    assert np.sqrt(np.mean(np.square(errors))) < 0.5
    with pytest.raises(ValueError, match="keel"):
        refine(flight.views, flight.target_told, flight.camera, ranges=[replace(ranges[0], landmark="keel")])


def test_a_batch_names_the_inliers_of_each_view(flight: Simulation) -> None:
    views = list(flight.views)
    wrong = {3: 4, 17: 0, 30: 11}
    for k, j in wrong.items():
        pixels = views[k].pixels.copy()
        pixels[j] += 40.0
        views[k] = replace(views[k], pixels=pixels)
    views[9] = replace(views[9], landmarks=(), pixels=np.empty((0, 2)), covariances=np.empty((0, 2, 2)))
    estimates = refine(views, flight.target_told, flight.camera).estimates
    for k, (view, estimate) in enumerate(zip(views, estimates, strict=True)):
        assert estimate.inliers == tuple(name for j, name in enumerate(view.landmarks) if wrong.get(k) != j)
        assert estimate.n_inliers == len(estimate.inliers)


def test_the_motion_of_the_target_holds_in_a_batch(flight: Simulation) -> None:

    moving = replace(flight.target_told, motion=MotionPrior(kind="range", jerk_density_m_s25=0.5))
    told = refine(flight.views, moving, flight.camera)
    option = refine(flight.views, flight.target_told, flight.camera, TrackerOptions(motion="range"))
    none = refine(flight.views, flight.target_told, flight.camera)
    np.testing.assert_array_equal(told.estimates[3].T_camera_target, option.estimates[3].T_camera_target)
    spread = [np.trace(e.estimates[3].covariance) for e in (told, none)]
    assert spread[0] < 0.6 * spread[1]  # what is left is the scale of the model
