# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Where the camera flies: positions and their derivatives, by hand and by differences."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fairlead.io.errors import InputError
from fairlead.io.tum import read_trajectory_tum, write_trajectory_tum
from fairlead.simulate import (
    Approach,
    Arc,
    ArcScenario,
    Frames,
    Helix,
    Leg,
    Legs,
    Orbit,
    OrbitScenario,
    Recorded,
    Rendezvous,
    simulate,
)
from fairlead.types import TruthPose

G = 9.80665


def velocity(path, t, h=1e-3):
    return (path.centres(t + h) - path.centres(t - h)) / (2 * h)


def acceleration(path, t, h=1e-2):
    return (path.centres(t + h) - 2 * path.centres(t) + path.centres(t - h)) / h**2


def test_the_arc_is_the_published_one(ship, plain):
    """Ten views over 27 s: the poses and stamps of ArcScenario."""
    arc = replace(plain, trajectory=Arc(duration_s=27.0), frames=Frames(count=10))
    flight = simulate(arc, 0)
    np.testing.assert_allclose(flight.T_true, ArcScenario().poses(ship[0].positions), atol=1e-9)
    assert [view.stamp_ns for view in flight.views] == [3_000_000_000 * k for k in range(10)]


def test_the_orbit_is_that_of_the_long_flight(ship, plain):
    orbit = replace(plain, trajectory=Orbit(range_m=1000.0, duration_s=4.0), frames=Frames(rate_hz=25.0))
    expected = OrbitScenario().poses(ship[0].positions, np.arange(101))
    np.testing.assert_allclose(simulate(orbit, 0).T_true, expected, atol=1e-9)


@given(st.floats(1.0, 60.0), st.floats(500.0, 3000.0), st.floats(100.0, 500.0))
def test_a_rendezvous_is_straight_and_its_ends_are_the_angle_apart(angle_deg, start_m, end_m):
    path = Rendezvous(angle_deg=angle_deg, start_range_m=start_m, end_range_m=end_m, duration_s=20.0)
    centres = path.centres(np.linspace(0.0, 20.0, 9))
    np.testing.assert_allclose(np.diff(centres, axis=0), np.tile(centres[-1] - centres[0], (8, 1)) / 8, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(centres[[0, -1]], axis=1), [start_m, end_m])
    level = centres[[0, -1], :2] / np.linalg.norm(centres[[0, -1], :2], axis=1, keepdims=True)
    assert np.degrees(np.arccos(np.clip(level[0] @ level[1], -1, 1))) == pytest.approx(angle_deg, abs=1e-5)


def test_an_approach_slows_down_to_rest_over_the_hover():
    """600 m at 25 m/s, at most 1.5 m/s^2: 11.5 s at speed, 25 s of braking, then at rest at the hover."""
    path = Approach(distance_m=600.0, speed_m_s=25.0, deceleration_m_s2=1.5, hover_s=10.0)
    assert path.braking_s == 25.0
    assert path.cruise_s == pytest.approx(600 / 25 - 12.5)
    assert path.length_s == pytest.approx(11.5 + 25.0 + 10.0)
    start = path.centres(np.zeros(1))[0] - path.hover_m
    np.testing.assert_allclose(start, 600 * np.array([-np.cos(np.radians(6)), 0, np.sin(np.radians(6))]), atol=1e-9)
    t = np.linspace(0.1, path.length_s - 0.1, 400)
    speed = np.linalg.norm(velocity(path, t), axis=1)
    np.testing.assert_allclose(speed[t < 11.4], 25.0, rtol=1e-6)
    slowing = np.linalg.norm(acceleration(path, t), axis=1)
    assert slowing.max() == pytest.approx(1.5, rel=1e-3)
    np.testing.assert_allclose(path.centres(np.array([36.6, 46.0])), [path.hover_m] * 2, atol=1e-9)
    with pytest.raises(ValueError, match=r"distance_m: expected at least the 312\.5 m"):
        Approach(distance_m=300.0)


def test_a_helix_by_hand():
    path = Helix(radius_m=100.0, start_height_m=10.0, end_height_m=30.0, turns=1.0, duration_s=4.0)
    expected = [[-100, 0, 10], [0, -100, 15], [100, 0, 20], [0, 100, 25], [-100, 0, 30]]
    np.testing.assert_allclose(path.centres(np.arange(5.0)), expected, atol=1e-9)


def test_a_turn_pulls_its_load_and_keeps_the_speed():
    """3 g to port at 60 m/s: 29.42 m/s^2 across the track, radius v^2 / a = 122.4 m; the jerk stays finite."""
    path = Legs(speed_m_s=60.0, ease_s=0.5, leg=(Leg(duration_s=2.0), Leg(duration_s=4.0, turn_g=3.0)))
    t = np.linspace(2.6, 5.4, 30)
    v, a = velocity(path, t), acceleration(path, t)
    np.testing.assert_allclose(np.linalg.norm(v, axis=1), 60.0, rtol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(a, axis=1), 3 * G, rtol=1e-4)
    np.testing.assert_allclose(np.sum(v * a, axis=1), 0.0, atol=1.0)
    assert (np.cross(v, a)[:, 2] > 0.0).all()  # to port
    jerk = np.diff(acceleration(path, np.arange(0.1, 5.9, 0.02)), axis=0) / 0.02
    assert np.linalg.norm(jerk, axis=1).max() < 1.1 * 1.5 * 3 * G / 0.5 + 3 * G * 3 * G / 60.0


def test_legs_stop_climb_and_go_on():
    path = Legs(
        speed_m_s=40.0,
        heading_deg=90.0,
        leg=(
            Leg(duration_s=8.0, speed_m_s=0.0),
            Leg(duration_s=2.0),
            Leg(duration_s=4.0, climb_m_s=5.0, speed_m_s=8.0),
        ),
    )
    centres = path.centres(np.array([0.0, 8.0, 10.0]))
    np.testing.assert_allclose(centres - path.start_m, [[0, 0, 0], [0, 160, 0], [0, 160, 0]], atol=1e-6)
    np.testing.assert_allclose(velocity(path, np.array([13.99])), [[0.0, 8.0, 5.0]], atol=0.01)
    with pytest.raises(ValueError, match=r"leg\[1\].turn_g: expected 0 where the speed is 0"):
        Legs(leg=(Leg(duration_s=8.0, speed_m_s=0.0), Leg(duration_s=2.0, turn_g=1.0)))


def test_a_recorded_flight_is_flown_again(tmp_path, plain):
    """Written as trajectory.tum, read and flown: the same poses at the same stamps; between them a smooth curve."""
    flown = simulate(plain, 1)
    late = [replace(pose, stamp_ns=pose.stamp_ns + 7_000_000_000) for pose in flown.truth]
    write_trajectory_tum(tmp_path / "flown.tum", late)
    again = simulate(replace(plain, trajectory=Recorded(file=tmp_path / "flown.tum"), frames=Frames()), 2)
    np.testing.assert_allclose(again.T_true, flown.T_true, atol=1e-8)
    assert [view.stamp_ns for view in again.views] == [view.stamp_ns for view in flown.views]
    finer = replace(plain, frames=Frames(rate_hz=20.0))
    truth = simulate(finer, 1).T_true
    between = simulate(replace(finer, trajectory=Recorded(file=tmp_path / "flown.tum")), 2).T_true
    np.testing.assert_allclose(between[8:-8, :3, 3], truth[8:-8, :3, 3], atol=0.05)


def test_tum_comes_back(tmp_path, plain):
    truth = simulate(plain, 1).truth
    write_trajectory_tum(tmp_path / "a.tum", truth)
    stamps_ns, T = read_trajectory_tum(tmp_path / "a.tum")
    assert stamps_ns.tolist() == [pose.stamp_ns for pose in truth]
    np.testing.assert_allclose(np.linalg.inv(T), [pose.T_camera_target for pose in truth], atol=1e-9)
    assert isinstance(truth[0], TruthPose)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1 2 3\n", "a.tum:1: expected stamp tx ty tz qx qy qz qw, got 3 cells"),
        ("# c\n0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 2\n", "a.tum:3: expected a unit quaternion"),
        ("x 0 0 0 0 0 0 1\n", "a.tum:1: expected eight numbers"),
        ("0 0 0 0 0 0 0 nan\n", "a.tum:1: expected eight finite numbers"),
        ("0 0 0 0 0 0 0 1\n", "expected at least 2 poses"),
        ("1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n", "expected stamps that grow; pose 2"),
    ],
)
def test_a_wrong_recording_is_one_line(tmp_path, text, message):
    (tmp_path / "a.tum").write_text(text)
    with pytest.raises(InputError) as caught:
        Recorded(file=tmp_path / "a.tum").length_s  # noqa: B018 - read when it is needed
    assert message in str(caught.value)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Arc(range_m=0.0),
        lambda: Orbit(elevation_deg=90.0),
        lambda: Helix(duration_s=-1.0),
        lambda: Legs(leg=()),
        lambda: Legs(leg=(Leg(duration_s=4000.0),)),
        lambda: Frames(rate_hz=1.0, count=3),
        lambda: Frames(drop_share=2.0),
    ],
)
def test_impossible_flights_are_refused(make):
    with pytest.raises(ValueError, match=r"^[a-z_]+: expected"):
        make()
