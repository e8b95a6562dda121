# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fairlead.geometry import log_so3, transform
from fairlead.simulate import Shake, Shifting, TargetMotion, Turning
from fairlead.simulate.streams import Streams
from fairlead.simulate.target_motion import box_centre

LONG = np.arange(0.0, 4000.0, 0.1)


@given(st.floats(0.1, 20.0), st.tuples(st.floats(6.0, 9.0), st.floats(9.0, 12.0)), st.integers(0, 1000))
def test_one_wave_rolls_to_its_amplitude_within_its_periods(ship, amplitude_deg, period_s, seed):
    """Largest angle = amplitude (sampled at 1/60 of the period: 0.14 %), zero crossings two per period."""
    motion = TargetMotion(roll=Turning(amplitude_deg=amplitude_deg, period_s=period_s))
    R = motion.draw(ship[0], Streams(seed))(LONG[:10_000])[:, :3, :3]
    np.testing.assert_allclose(R[:, 0, 0], 1.0, atol=1e-12)  # about x alone
    angle = np.degrees(np.arctan2(R[:, 2, 1], R[:, 1, 1]))
    assert np.abs(angle).max() == pytest.approx(amplitude_deg, rel=2e-3)
    crossings = np.count_nonzero(np.diff(np.sign(angle)))
    assert 2 * 1000 / period_s[1] - 1 <= crossings <= 2 * 1000 / period_s[0] + 1


@pytest.mark.parametrize("waves", [1, 3, 30])
def test_several_waves_have_the_mean_square_of_one(ship, waves):
    """rms = amplitude / sqrt(2) over 4,000 s, the longest beat of few waves apart: 15 %."""
    motion = TargetMotion(heave=Shifting(amplitude_m=2.0, period_s=(6.0, 12.0), waves=waves))
    T = motion.draw(ship[0], Streams(4))(LONG)
    assert np.sqrt(np.mean(T[:, 2, 3] ** 2)) == pytest.approx(2.0 / np.sqrt(2.0), rel=0.15)
    np.testing.assert_array_equal(T[:, :2, 3], 0.0)
    np.testing.assert_array_equal(T[:, :3, :3], np.broadcast_to(np.eye(3), (len(T), 3, 3)))


@given(st.sampled_from(["helo_spot", "bow"]), st.integers(0, 1000))
def test_the_named_point_stays_where_it_is_while_the_target_turns(ship, name, seed):
    turning = Turning(amplitude_deg=10.0)
    motion = TargetMotion(about=name, roll=turning, pitch=turning, yaw=turning)
    target = ship[0]
    point = target.positions[target.landmarks.index(name)]
    for T in motion.draw(target, Streams(seed))(np.linspace(0.0, 20.0, 7)):
        np.testing.assert_allclose(transform(T, point[None])[0], point, atol=1e-9)
        assert np.linalg.norm(log_so3(T[:3, :3])) < np.radians(3 * 10.0)


def test_rotations_are_yaw_pitch_roll_by_hand(ship):
    """At a phase of 90 degrees all angles are at their amplitude at the start: Rz(6) Ry(4) Rx(2)."""
    parts = {"roll": 2.0, "pitch": 4.0, "yaw": 6.0}
    motion = TargetMotion(
        **{axis: Turning(amplitude_deg=value, period_s=10.0, phase_deg=90.0) for axis, value in parts.items()}
    )
    R = motion.draw(ship[0], Streams(0))(np.zeros(1))[0, :3, :3]
    (cr, sr), (cp, sp), (cy, sy) = ((np.cos(np.radians(v)), np.sin(np.radians(v))) for v in parts.values())
    Rz = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    Ry = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    Rx = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    np.testing.assert_allclose(R, Rz @ Ry @ Rx, atol=1e-14)


def test_without_a_point_it_turns_about_the_middle(ship):
    np.testing.assert_array_equal(TargetMotion().point(ship[0]), box_centre(ship[0].positions))
    np.testing.assert_array_equal(TargetMotion(about_m=(1.0, 2.0, 3.0)).point(ship[0]), [1, 2, 3])


def test_shake_has_its_rms_about_every_axis():
    """0.3 degrees rms per camera axis over 400 s, 5 %; sway likewise."""
    shake = Shake(sigma_deg=0.3, sway_m=2.0)
    t = np.arange(0.0, 400.0, 0.013)
    turning, swaying = shake.turning(Streams(3)), shake.swaying(Streams(3))
    phi = np.array([log_so3(R) for R in turning(t[:5000])])
    np.testing.assert_allclose(np.degrees(phi.std(axis=0)), 0.3, rtol=0.05)
    np.testing.assert_allclose(swaying(t).std(axis=0), 2.0, rtol=0.1)
    assert Shake().turning(Streams(3)) is None


def test_impossible_motion_is_refused(ship):
    with pytest.raises(ValueError, match="period_s: expected two numbers"):
        Turning(period_s=(10.0, 8.0))
    with pytest.raises(ValueError, match="about: expected about or about_m"):
        TargetMotion(about="bow", about_m=(0.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="about: expected a landmark of frigate, got 'keel'"):
        TargetMotion(about="keel").point(ship[0])
