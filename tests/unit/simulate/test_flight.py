# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""One flight as a whole: the same bits for the same seed, and effects that leave each other alone."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fairlead.simulate import (
    AttitudeSensor,
    Dropout,
    Frames,
    ModelError,
    Noise,
    Occlusion,
    Outliers,
    RangeFinder,
    Scenario,
    Shake,
    Shifting,
    Swaps,
    TargetMotion,
    Turning,
    load_scenario,
    project_all,
    shipped_scenarios,
    simulate,
)
from fairlead.simulate.streams import Streams


def noise_of(flight):
    """What was added to the true pixels, by frame and landmark [px]."""
    column = {name: index for index, name in enumerate(flight.target_true.landmarks)}
    exact = project_all(flight.camera, flight.X_true, flight.T_true)
    return {
        (view.frame, name): pixel - z[column[name]]
        for view, z in zip(flight.views, exact, strict=True)
        for name, pixel in zip(view.landmarks, view.pixels, strict=True)
    }


def readings_of(flight):
    return [(reading.stamp_ns, reading.range_m) for reading in flight.ranges]


EFFECTS = {
    "shake": {"shake": Shake(sigma_deg=0.3, sway_m=1.0)},
    "jitter": {"frames": Frames(rate_hz=5.0, jitter_s=0.01, stamp_sigma_s=0.01)},
    "drops": {"frames": Frames(rate_hz=5.0, drop_share=0.3, drop_s=0.5)},
    "outliers": {"outliers": Outliers(share=0.2, size_px=500.0)},
    "swaps": {"swaps": Swaps(share=0.2)},
    "dropout": {"dropout": Dropout(share=0.2, burst_share=0.2)},
    "occlusion": {"occlusion": Occlusion(kind="normals"), "normals": {"hangar_base": (1.0, 0.0, 0.0)}},
    "target_motion": {"target_motion": TargetMotion(roll=Turning(), heave=Shifting())},
    "model": {"model": ModelError(sigma_m=2.0, scale_sigma=0.1, correlation_length_m=5.0)},
    "told": {"noise": Noise(told_factor=3.0)},
    "range": {"range": (RangeFinder(), RangeFinder(outlier_share=0.5))},
    "attitude": {"attitude": AttitudeSensor(rate_hz=3.0)},
}


@given(st.sets(st.sampled_from(sorted(EFFECTS))), st.integers(0, 2**64))
def test_effects_leave_the_noise_and_the_model_of_all_others_alone(plain, names, seed):
    """Any set of effects switched on: what is not spoilt or swapped has the noise that it had without them."""
    changes = {key: value for name in names for key, value in EFFECTS[name].items()}
    before, after = simulate(plain, seed), simulate(replace(plain, **changes), seed)
    noise = noise_of(before)
    differences = [np.abs(e - noise[key]).max() for key, e in noise_of(after).items()]
    untouched = np.count_nonzero(np.array(differences) < 1e-7)
    if names & {"outliers", "swaps"}:
        assert untouched > 0.3 * len(differences)
    else:
        assert untouched == len(differences)
    if "model" not in names:
        np.testing.assert_array_equal(after.target_told.positions, before.target_told.positions)
    if not names & {"shake", "jitter", "drops", "target_motion"}:
        np.testing.assert_array_equal(after.T_true, before.T_true)


@given(st.sets(st.sampled_from(sorted(set(EFFECTS) - {"range", "shake", "jitter", "target_motion"}))))
def test_effects_leave_the_range_finder_alone(plain, names):
    """The readings of a finder with a rate of its own do not know what the detector does."""
    ranging = replace(plain, range=(RangeFinder(rate_hz=2.0, outlier_share=0.2),))
    changes = {key: value for name in names for key, value in EFFECTS[name].items()}
    assert readings_of(simulate(replace(ranging, **changes), 4)) == readings_of(simulate(ranging, 4))


def test_a_second_range_finder_leaves_the_first_alone(plain):
    one = replace(plain, range=(RangeFinder(landmark="bow"),))
    two = replace(plain, range=(*one.range, RangeFinder(outlier_share=0.3)))
    first = [reading for reading in simulate(two, 4).ranges if reading.landmark == "bow"]
    assert first == list(simulate(one, 4).ranges)


@pytest.mark.parametrize("name", ["rough", "landing"])
def test_the_same_seed_gives_the_same_bits(name):
    scenario = load_scenario(name).scenario
    short = replace(scenario, frames=replace(scenario.frames, rate_hz=3.0))
    a, b, c = simulate(short, 11), simulate(short, 11), simulate(short, 12)
    for one, other in zip(a.views, b.views, strict=True):
        assert (one.frame, one.stamp_ns, one.landmarks) == (other.frame, other.stamp_ns, other.landmarks)
        np.testing.assert_array_equal(one.pixels, other.pixels)
        np.testing.assert_array_equal(one.covariances, other.covariances)
    np.testing.assert_array_equal(a.T_true, b.T_true)
    np.testing.assert_array_equal(a.target_told.positions, b.target_told.positions)
    assert a.ranges == b.ranges
    assert a.ranges != c.ranges
    assert [r.R_world_camera.tobytes() for r in a.attitudes] == [r.R_world_camera.tobytes() for r in b.attitudes]
    assert a.target_told.positions.tobytes() != c.target_told.positions.tobytes()


def test_seeds_may_be_several_numbers(plain):
    assert not np.array_equal(
        simulate(plain, [1, 2]).target_told.positions, simulate(plain, [2, 1]).target_told.positions
    )
    np.testing.assert_array_equal(simulate(plain, [5]).target_told.positions, simulate(plain, 5).target_told.positions)
    with pytest.raises(ValueError, match="seed: expected whole numbers >= 0"):
        simulate(plain, -1)


def test_streams_differ_by_effect_and_by_index():
    streams = Streams(0)
    drawn = [streams.of("noise").random(), streams.of("tail").random(), streams.of("range", 1).random()]
    assert len({*drawn, streams.of("range").random()}) == 4
    assert streams.of("noise").random() == drawn[0]


def test_a_longer_flight_begins_alike(plain):
    """White noise and drops of the first images do not depend on how many follow."""
    frames = Frames(rate_hz=5.0, drop_share=0.2)
    dropping = replace(plain, frames=frames)
    short = simulate(replace(dropping, trajectory=replace(plain.trajectory, duration_s=4.0, angle_deg=36.0)), 3)
    long = simulate(dropping, 3)
    assert [v.frame for v in short.views] == [v.frame for v in long.views if v.frame <= 20]
    noise = noise_of(long)
    for key, e in noise_of(short).items():
        np.testing.assert_allclose(e, noise[key], atol=1e-9)


def test_jitter_moves_the_camera_and_errors_of_stamps_do_not(plain):
    """Jitter: the stamp is true, the pose that of the path at the stamp. Wrong stamps: the pose is that of the turn."""
    jittered = simulate(replace(plain, frames=Frames(rate_hz=5.0, jitter_s=0.02)), 2)
    stamps_s = np.array([view.stamp_ns for view in jittered.views]) / 1e9
    assert 0.01 < (stamps_s - np.arange(51) / 5).std() < 0.03
    centres = -np.einsum("kji,kj->ki", jittered.T_true[:, :3, :3], jittered.T_true[:, :3, 3])
    np.testing.assert_allclose(centres, plain.trajectory.centres(stamps_s), atol=1e-5)
    wrong = simulate(replace(plain, frames=Frames(rate_hz=5.0, stamp_sigma_s=10.0)), 2)
    np.testing.assert_array_equal(wrong.T_true, simulate(plain, 2).T_true)
    assert (np.diff([view.stamp_ns for view in wrong.views]) > 0).all()


def test_nothing_is_found_outside_the_image(ship, plain):
    """From 300 m astern the ship fills the image and more; what is found lies within it up to the noise."""
    near = replace(plain, trajectory=replace(plain.trajectory, range_m=160.0))
    flight = simulate(near, 1)
    assert 0 < sum(len(view.landmarks) for view in flight.views) < 20 * len(flight.views)
    for view, true in zip(flight.views, flight.views_true, strict=True):
        assert view.landmarks == true.landmarks
        assert view.pixels.min() > -6.0
        assert view.pixels.max() < 1030.0
        assert not true.covariances.any()
        assert np.abs(view.pixels - true.pixels).max() < 6.0


@pytest.mark.parametrize("name", shipped_scenarios())
def test_what_comes_along_can_be_flown(name):
    """Every scenario, 30 images of it: the ship is in sight in all of them, with 8 landmarks in at least half."""
    scenario = load_scenario(name).scenario
    assert isinstance(scenario, Scenario)
    flight = simulate(replace(scenario, frames=Frames(count=30)), scenario.seed)
    found = np.array([len(view.landmarks) for view in flight.views])
    assert np.median(found) >= 8
    assert found.min() >= 5 or scenario.dropout.blackout_s
    ranges = np.linalg.norm(flight.T_true[:, :3, 3], axis=1)
    assert ranges.min() > 50.0
    assert ranges.max() < 2500.0
