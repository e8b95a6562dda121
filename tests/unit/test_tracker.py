# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The typed wrappers of the core: what they hand on, and what they return."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import jaxtyping
import numpy as np
import pytest

from fairlead.simulate import ArcScenario, ModelError, ObservationError, Simulation, simulate_arc
from fairlead.tracker import Tracker, TrackerOptions, refine
from fairlead.types import AttitudeReading, KnownDistance, MotionPrior, RangeReading, View

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


@pytest.fixture
def as_in_production() -> Iterator[None]:
    """Annotations are checked in tests only; here it is asked what the wrappers check by themselves."""
    jaxtyping.config.update("jaxtyping_disable", True)
    yield
    jaxtyping.config.update("jaxtyping_disable", False)


@pytest.mark.usefixtures("as_in_production")
@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"seed": -1}, "seed: got -1, expected a whole number >= 0"),
        ({"max_views": 10**14}, "max_views: got 100000000000000, expected a smaller whole number"),
        ({"max_views": 3.5}, "max_views: got 3.5, expected a whole number"),
        ({"max_views": "a"}, "max_views: got 'a', expected a whole number"),
        ({"max_views": 1}, "max_views: got 1.000000, expected 2 to 4096"),
        ({"gate": None}, "gate: got None, expected a number"),
        ({"gate": 10**400}, "expected a number"),
        ({"motion": 3}, "motion: got 3, expected text"),
        ({"motion": "warp"}, "got 'warp', expected none, range, target or world"),
        ({"range_to_origin": 1}, "range_to_origin: got 1, expected true or false"),
    ],
)
def test_an_option_that_cannot_be_is_one_line(flight: Simulation, changes: dict[str, Any], message: str) -> None:
    options = TrackerOptions(**changes)
    for use in (options.check, lambda: Tracker(flight.target_told, flight.camera, options)):
        with pytest.raises(ValueError, match="expected") as caught:
            use()
        assert message in str(caught.value)
        assert "\n" not in str(caught.value)


@pytest.mark.usefixtures("as_in_production")
def test_what_is_handed_over_in_the_wrong_place_is_one_line(flight: Simulation) -> None:
    target, camera, views = flight.target_told, flight.camera, list(flight.views)
    wrong: Any = {"gate": 1.0}
    for use, message in (
        (lambda: Tracker(camera, target), "target: expected Target, got Camera"),
        (lambda: refine(views, camera, target), "target: expected Target, got Camera"),
        (lambda: Tracker(target, camera, wrong), "options: expected TrackerOptions, got dict"),
        (lambda: Tracker(target, camera, {}), "options: expected TrackerOptions, got dict"),
        (lambda: refine(None, target, camera), "views: expected Iterable, got NoneType"),
        (lambda: refine([None], target, camera), "views: expected View, got NoneType"),
        (lambda: refine(views, target, camera, ranges=[3.0]), "ranges: expected RangeReading, got float"),
        (lambda: Tracker(target, camera).update(None), "view: expected View, got NoneType"),
        (lambda: Tracker(target, camera).predict(1.0), "stamp_ns: expected an integer, got 1.0"),
        (lambda: Tracker(target, camera).add_range(1.0, 5.0, 1.0), "range stamp_ns: expected an integer, got 1.0"),
        (lambda: Tracker(target, camera).add_range(1, "far", 1.0), "range range_m: expected a number, got 'far'"),
        (lambda: Tracker(target, camera).add_pose(0, np.eye(4), np.eye(5)), "pose covariance: expected shape (6, 6)"),
    ):
        with pytest.raises(ValueError, match="expected") as caught:
            use()  # pyright: ignore[reportUnknownArgumentType]
        assert message in str(caught.value)
        assert "\n" not in str(caught.value)


@pytest.mark.usefixtures("as_in_production")
def test_plain_lists_do_as_well_as_arrays(flight: Simulation) -> None:
    start: Any = flight.T_true[0]
    attitude = np.asarray(start)[:3, :3].T
    found: list[np.ndarray] = []
    for plain in (False, True):
        tracker = Tracker(flight.target_told, flight.camera, TrackerOptions(motion="world"))
        tracker.add_pose(0, start.tolist() if plain else start, np.eye(6).tolist() if plain else np.eye(6))
        tracker.add_attitude(0, attitude.tolist() if plain else attitude, 1e-3)
        found.append(tracker.update(flight.views[0]).T_camera_target)
    np.testing.assert_array_equal(*found)


def test_observations_that_no_estimator_can_use_are_counted(flight: Simulation) -> None:
    view = flight.views[0]
    covariances = view.covariances.copy()
    covariances[0] = 0.0
    covariances[1, 0, 0] = -1.0
    covariances[2] = [[1.0, 2.0], [2.0, 1.0]]
    spoilt = replace(view, covariances=covariances)
    assert Tracker(flight.target_told, flight.camera).update(spoilt).n_dropped == 3
    assert [e.n_dropped for e in refine([view, spoilt], flight.target_told, flight.camera).estimates] == [0, 3]
    useless = View(
        frame=0, stamp_ns=0, landmarks=view.landmarks, pixels=view.pixels, covariances=np.zeros_like(covariances)
    )
    assert Tracker(flight.target_told, flight.camera).update(useless).n_dropped == len(view.landmarks)
