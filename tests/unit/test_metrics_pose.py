# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""docs/metrics.md eq. (1)-(7), computed by hand."""

import math

import numpy as np
import pytest

from fairlead.evaluate.failures import FAILURE_POSITION_PERCENT, coverage, failed_frames, penalised_mean
from fairlead.evaluate.pose import (
    camera_positions,
    position_error_m,
    range_m,
    rotation_error_deg,
    translation_error_m,
)
from fairlead.evaluate.pose_errors import pose_errors
from fairlead.evaluate.summary import summarise, update_time
from fairlead.types import Estimate


def pose(R=None, t=(0.0, 0.0, 0.0)) -> np.ndarray:
    T = np.eye(4)
    T[:3, :3] = np.eye(3) if R is None else R
    T[:3, 3] = t
    return T[None]


def about_z(angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def estimate(*, ok: bool, reason: str = "", resets: int = 0) -> Estimate:
    return Estimate(
        frame=0,
        stamp_ns=0,
        status="tracking" if ok else "lost",
        reason=reason,
        T_camera_target=np.eye(4) if ok else np.full((4, 4), np.nan),
        covariance=np.eye(6) if ok else np.full((6, 6), np.nan),
        n_inliers=0,
        reprojection_rms_px=0.0,
        information_gained=0.0,
        reset_counter=resets,
        inliers=(),
    )


def test_summary_eq_1() -> None:
    summary = summarise(np.array([1.0, 2.0, np.nan, 3.0, 4.0]))
    assert summary.count == 4
    assert summary.mean == 2.5
    assert summary.rms == pytest.approx(math.sqrt(30.0 / 4.0))
    assert summary.median == 2.5
    assert summary.p95 == pytest.approx(3.85)  # 1 + 0.95 x 3
    assert summary.maximum == 4.0


def test_summary_of_nothing_is_nan_and_says_so() -> None:
    summary = summarise(np.array([np.nan]))
    assert summary.count == 0
    assert math.isnan(summary.mean)
    assert math.isnan(summary.p95)


@pytest.mark.parametrize("angle", [1e-9, 1e-4, 0.3, math.pi / 2, math.pi - 1e-9, math.pi])
def test_rotation_eq_2_keeps_its_digits_at_both_ends(angle: float) -> None:
    error = rotation_error_deg(pose(about_z(0.2)), pose(about_z(0.2 + angle)))
    assert error[0] == pytest.approx(math.degrees(angle), rel=1e-6)


def test_rotation_does_not_depend_on_the_axes_of_the_camera() -> None:
    R = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    error = rotation_error_deg(pose(R @ about_z(0.1)), pose(R))
    assert error[0] == pytest.approx(math.degrees(0.1))


def test_translation_eq_3() -> None:
    T_true = pose(t=(0.0, 0.0, 10.0))
    assert translation_error_m(pose(t=(3.0, 4.0, 10.0)), T_true)[0] == 5.0
    assert range_m(T_true)[0] == 10.0
    assert pose_errors(pose(t=(3.0, 4.0, 10.0)), T_true).translation_percent.values[0] == 50.0


def test_camera_position_eq_4() -> None:
    T = pose(np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]), (1.0, 2.0, 3.0))
    assert camera_positions(T)[0].tolist() == [-2.0, 1.0, -3.0]
    # Same translation, rotated by 180 deg about z: c = (1, 2, -3) against (-1, -2, -3).
    assert position_error_m(pose(about_z(math.pi), (1.0, 2.0, 3.0)), pose(t=(1.0, 2.0, 3.0)))[0] == pytest.approx(
        2.0 * math.sqrt(5.0)
    )


def test_failure_eq_5_counts_the_limits_themselves_as_good() -> None:
    rotation = np.array([30.0, 30.01, 0.0, 0.0, np.nan])
    percent = np.array([25.0, 0.0, 25.01, 0.0, np.nan])
    assert failed_frames(rotation, percent).tolist() == [False, True, True, False, True]


def test_penalised_mean_eq_6() -> None:
    errors = np.array([1.0, 3.0, 90.0, np.nan])
    failed = np.array([False, False, True, True])
    assert penalised_mean(errors, failed, np.full(4, 30.0)) == 16.0  # (1 + 3 + 30 + 30) / 4


def test_position_limit_eq_6_is_reached_by_no_frame_that_does_not_fail() -> None:
    assert pytest.approx(76.7638, abs=1e-4) == FAILURE_POSITION_PERCENT
    # The worst case of both limits at once: rotation 30 deg about y, translation 25 % along the same chord.
    angle = math.radians(30.0)
    R = np.array([[math.cos(angle), 0, math.sin(angle)], [0, 1, 0], [-math.sin(angle), 0, math.cos(angle)]])
    T_true = pose(t=(0.0, 0.0, 8.0))
    chord = R @ (T_true[0, :3, 3] - R.T @ T_true[0, :3, 3])
    t = T_true[0, :3, 3] + 2.0 * chord / -np.linalg.norm(chord)
    T = pose(R, t)
    errors = pose_errors(T, T_true)
    assert errors.translation_percent.values[0] == pytest.approx(25.0)
    assert errors.rotation_deg.values[0] == pytest.approx(30.0)
    assert errors.position_percent.values[0] <= FAILURE_POSITION_PERCENT + 1e-9
    assert errors.position_percent.values[0] > 70.0


def test_failures_are_split_into_silent_and_wrong() -> None:
    T = np.concatenate([pose(t=(0, 0, 10.0)), pose(about_z(1.0), (0, 0, 10.0)), np.full((1, 4, 4), np.nan)])
    failures = pose_errors(T, np.repeat(pose(t=(0, 0, 10.0)), 3, axis=0)).failures
    assert (failures.n_frames, failures.n_wrong, failures.n_without_pose) == (3, 1, 1)
    assert failures.rate == pytest.approx(2 / 3)


def test_silence_does_not_improve_the_penalised_mean() -> None:
    T_true = np.repeat(pose(t=(0, 0, 10.0)), 2, axis=0)
    bad = np.concatenate([pose(t=(0, 0, 10.0)), pose(t=(0, 0, 12.4))])
    silent = bad.copy()
    silent[1] = np.nan
    spoken, kept_quiet = pose_errors(bad, T_true), pose_errors(silent, T_true)
    assert kept_quiet.translation_m.summary.mean < spoken.translation_m.summary.mean
    assert kept_quiet.translation_m.penalised > spoken.translation_m.penalised


def test_coverage_eq_7() -> None:
    run = [
        estimate(ok=False, reason="too_few"),
        estimate(ok=True),
        estimate(ok=False, reason="gated", resets=1),
        estimate(ok=True, reason="contradiction", resets=2),
        estimate(ok=True, reason="ambiguous", resets=2),
        estimate(ok=False, reason="gated", resets=2),
    ]
    found = coverage(run)
    assert (found.n_frames, found.n_ok, found.rate, found.first_ok, found.n_resets) == (6, 3, 0.5, 1, 2)
    assert found.reasons == (("gated", 2), ("too_few", 1))
    assert found.doubts == (("contradiction", 1),)


def test_coverage_of_no_frames_is_nan() -> None:
    assert math.isnan(coverage([]).rate)
    assert coverage([]).first_ok is None


def test_update_time_eq_24() -> None:
    times = update_time(np.array([*np.arange(101.0), np.nan]))
    assert times is not None
    assert (times.count, times.p50_ms, times.p99_ms, times.mean_ms, times.maximum_ms) == (101, 50.0, 99.0, 50.0, 100.0)
    assert update_time(np.array([np.nan])) is None


def test_an_infinite_error_shows_where_it_lies() -> None:
    summary = summarise(np.array([1.0, 2.0, 3.0, np.inf]))
    assert summary.median == 2.5
    assert summary.mean == summary.rms == summary.p95 == summary.maximum == math.inf
