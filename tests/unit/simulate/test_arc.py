# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest

from fairlead.io.camera import load_camera
from fairlead.io.target import load_target
from fairlead.simulate import (
    ArcScenario,
    ModelError,
    ObservationError,
    OrbitScenario,
    orbit_told,
    orbit_views,
    simulate_arc,
)


@pytest.fixture(scope="module")
def frigate(repository):
    folder = repository / "data" / "frigate"
    return load_target(folder / "target.toml"), load_camera(folder / "camera.yaml")


def test_frigate_is_140_by_18_by_32(frigate):
    """The table's box, its mirror pairs, and the touchdown point that is one of its landmarks."""
    target, camera = frigate
    X = dict(zip(target.landmarks, target.positions, strict=True))
    assert len(X) == 20
    assert target.positions[:, 0].max() == 140.0
    assert np.ptp(target.positions[:, 1]) == 18.0
    assert target.positions[:, 2].max() == 32.0
    assert target.positions.min(axis=0)[[0, 2]].min() >= 0.0
    for name in X:
        if name.endswith("_p"):
            np.testing.assert_array_equal(X[name] * [1, -1, 1], X[name[:-1] + "s"])
            assert X[name][1] > 0
    np.testing.assert_array_equal(target.touchdown, X["helo_spot"])
    np.testing.assert_array_equal(target.covariance, np.eye(60))
    np.testing.assert_array_equal(camera.K, [[1910, 0, 511.5], [0, 1910, 511.5], [0, 0, 1]])


def test_whole_ship_is_in_every_image(frigate):
    flight = simulate_arc(*frigate, ArcScenario(angle_deg=180.0), np.random.default_rng(0))
    pixels = np.stack([view.pixels for view in flight.views])
    assert pixels.min() > 0
    assert pixels.max() < 1023


def test_truth_and_told_differ_and_truth_explains_the_images(frigate):
    """Residuals of the truth are the noise (400 coordinates, 4 standard errors); the table is the truth."""
    scenario = ArcScenario(
        observation=ObservationError(sigma_px=2.0, told_factor=0.5), model=ModelError(told_factor=3.0)
    )
    flight = simulate_arc(*frigate, scenario, np.random.default_rng(5))
    np.testing.assert_array_equal(flight.X_true, frigate[0].positions)
    assert not flight.target_true.covariance.any()
    assert (flight.target_told.positions - flight.X_true).std() == pytest.approx(1.0, rel=4 / np.sqrt(120))
    np.testing.assert_array_equal(flight.target_told.covariance, 9.0 * np.eye(60))
    assert flight.target_told.touchdown is None
    np.testing.assert_array_equal(flight.views[3].covariances[7], np.eye(2))
    p = np.einsum("kij,nj->kni", flight.T_true[:, :3, :3], flight.X_true) + flight.T_true[:, None, :3, 3]
    z = 1910.0 * p[..., :2] / p[..., 2:] + 511.5
    noise = np.stack([view.pixels for view in flight.views]) - z
    assert noise.std() == pytest.approx(2.0, rel=4 / np.sqrt(800))
    assert [pose.stamp_ns for pose in flight.truth] == [view.stamp_ns for view in flight.views]


def test_same_seed_same_flight_whatever_is_told(frigate):
    """Seeds decide the model error and the noise; the told sigmas do not change them."""
    base = ArcScenario()
    told = replace(base, model=ModelError(told_factor=3.0), observation=ObservationError(told_factor=2.0))
    a, b = (simulate_arc(*frigate, scenario, np.random.default_rng([4, 2])) for scenario in (base, told))
    np.testing.assert_array_equal(a.target_told.positions, b.target_told.positions)
    for one, other in zip(a.views, b.views, strict=True):
        np.testing.assert_array_equal(one.pixels, other.pixels)


def test_orbit_streams_the_same_views_in_any_length(frigate):
    target, camera = frigate
    views = {}
    for frames in (300, 600):
        rng = np.random.default_rng(1)
        scenario = OrbitScenario(frames=frames)
        told = orbit_told(target, scenario, rng)
        views[frames] = list(orbit_views(target, camera, scenario, rng))
        assert not np.array_equal(told.positions, target.positions)
    assert [view.frame for view in views[600]] == list(range(600))
    assert views[600][25].stamp_ns == 1_000_000_000
    for short, long in zip(views[300][:250], views[600][:250], strict=True):
        np.testing.assert_array_equal(short.pixels, long.pixels)


def test_impossible_arc_is_refused():
    with pytest.raises(ValueError, match="at least one view"):
        ArcScenario(views=0)
