# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest

from fairlead.geometry import inverse, log_so3
from fairlead.simulate import AttitudeSensor, Frames, RangeFinder, Shake, TargetMotion, Turning, simulate


def test_a_range_is_the_distance_to_its_point(ship, plain):
    """To the origin and to the bow of a rolling ship: what the true poses of the images say, within the noise."""
    bow = ship[0].positions[ship[0].landmarks.index("bow")]
    finders = (RangeFinder(sigma_m=1e-6), RangeFinder(landmark="bow", sigma_m=1e-6))
    rolling = TargetMotion(roll=Turning(amplitude_deg=5.0), about="bow")
    flight = simulate(replace(plain, range=finders, target_motion=rolling), 1)
    for name, X in ((None, np.zeros(3)), ("bow", bow)):
        read = [reading for reading in flight.ranges if reading.landmark == name]
        expected = [np.linalg.norm(T[:3, :3] @ X + T[:3, 3]) for T in flight.T_true]
        np.testing.assert_allclose([reading.range_m for reading in read], expected, atol=1e-4)
        assert [reading.stamp_ns for reading in read] == [view.stamp_ns for view in flight.views]
    stamps = [reading.stamp_ns for reading in flight.ranges]
    assert stamps == sorted(stamps)


def test_ranges_err_as_told(plain):
    """10,000 readings on a still arc of 1 km: bias 2 m, sigma 0.5 m, 10 % off by 50 m to either side; 4 s.e."""
    finder = RangeFinder(rate_hz=1000.0, sigma_m=0.5, told_factor=2.0, bias_m=2.0, outlier_share=0.1)
    ranges = simulate(replace(plain, range=(finder,)), 3).ranges
    off = np.array([reading.range_m for reading in ranges]) - 1002.0
    assert len(off) == 10_001
    assert {reading.sigma_m for reading in ranges} == {1.0}
    good = np.abs(off) < 25.0
    assert 1 - good.mean() == pytest.approx(0.1, abs=4 * np.sqrt(0.09 / 1e4))
    assert off[good].std() == pytest.approx(0.5, rel=4 / np.sqrt(2 * 9000))
    assert off[good].mean() == pytest.approx(0.0, abs=4 * 0.5 / np.sqrt(9000))
    np.testing.assert_allclose(np.abs(off[~good]), 50.0, atol=3.0)
    assert (off[~good] > 0).mean() == pytest.approx(0.5, abs=4 * np.sqrt(0.25 / 1000))


def test_an_attitude_is_the_camera_s_and_not_the_target_s(plain):
    """Still target: R_world_camera of the poses. Rolling target: the same readings; only shake changes them."""
    sensor = AttitudeSensor(sigma_deg=1e-6)
    still = simulate(replace(plain, attitude=sensor), 1)
    rolling = simulate(replace(plain, attitude=sensor, target_motion=TargetMotion(roll=Turning())), 1)
    shaken = simulate(replace(plain, attitude=sensor, shake=Shake(sigma_deg=0.5)), 1)
    for reading, T in zip(still.attitudes, still.T_true, strict=True):
        np.testing.assert_allclose(reading.R_world_camera, inverse(T)[:3, :3], atol=1e-6)
        assert reading.R_world_camera[2, 1] < 0.0  # the camera's y axis points down
    for one, other in zip(still.attitudes, rolling.attitudes, strict=True):
        np.testing.assert_array_equal(one.R_world_camera, other.R_world_camera)
    for reading, T in zip(shaken.attitudes, shaken.T_true, strict=True):
        np.testing.assert_allclose(reading.R_world_camera, inverse(T)[:3, :3], atol=1e-6)


def test_attitudes_err_as_told(plain):
    """R_read = R_true Exp(e): 1,001 readings, sigma 0.2 degrees in each camera axis, and a constant bias."""
    rate = {"rate_hz": 100.0}
    exact = simulate(replace(plain, attitude=AttitudeSensor(sigma_deg=1e-9, **rate)), 5).attitudes
    for bias_deg in (0.0, 1.0):
        noisy = simulate(replace(plain, attitude=AttitudeSensor(bias_deg=bias_deg, **rate)), 5).attitudes
        pairs = zip(exact, noisy, strict=True)
        e = np.degrees([log_so3(a.R_world_camera.T @ b.R_world_camera) for a, b in pairs])
        np.testing.assert_allclose(e.std(axis=0), 0.2, rtol=5 / np.sqrt(2000))
        if bias_deg == 0.0:
            np.testing.assert_allclose(e.mean(axis=0), 0.0, atol=5 * 0.2 / np.sqrt(1000))
        else:
            assert np.linalg.norm(e.mean(axis=0)) > 0.2
    assert noisy[0].sigma_rad == pytest.approx(np.radians(0.2))


def test_readings_have_a_rate_of_their_own(plain):
    flight = simulate(replace(plain, range=(RangeFinder(rate_hz=2.0),), frames=Frames(count=3, drop_share=1.0)), 0)
    assert not flight.views
    assert [reading.stamp_ns for reading in flight.ranges] == [500_000_000 * k for k in range(21)]
