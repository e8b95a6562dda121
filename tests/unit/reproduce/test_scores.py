# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Means hold their failures, pairs are pairs."""

from dataclasses import replace

import numpy as np
import pytest

from fairlead.reproduce.methods import Flight, Track, confident_view, solve
from fairlead.reproduce.scores import on_common_frames, paired, score, summarise
from fairlead.types import View


@pytest.fixture(scope="module")
def tracks(flight: Flight) -> dict[str, Track]:
    return solve(flight)


def without_poses(track: Track, frames: slice) -> Track:
    T, S = track.T_camera_target.copy(), track.covariances.copy()
    T[frames], S[frames] = np.nan, np.nan
    return replace(track, T_camera_target=T, covariances=S)


def test_a_frame_without_a_pose_counts_with_the_limit(flight, tracks):
    whole, half = score(tracks["map"], flight), score(without_poses(tracks["map"], slice(0, 6)), flight)
    assert whole["coverage"] == 1.0
    assert whole["failed"] == 0.0
    assert half["coverage"] == 0.5
    assert half["failed"] == 0.5
    assert half["wrong"] == 0.0
    ranges = np.linalg.norm(flight.T_true[:6, :3, 3], axis=1)
    late = np.linalg.norm(tracks["map"].T_camera_target[6:, :3, 3] - flight.T_true[6:, :3, 3], axis=1)
    assert half["translation_all_m"] == pytest.approx((0.25 * ranges.sum() + late.sum()) / 12)
    assert half["translation_since_m"] == pytest.approx(late.mean())
    assert half["rotation_all_deg"] > 15.0


def test_a_useless_pose_is_wrong_and_not_silent(flight, tracks):
    T = tracks["map"].T_camera_target.copy()
    T[3, 2, 3] *= 2.0
    found = score(replace(tracks["map"], T_camera_target=T), flight)
    assert found["coverage"] == 1.0
    assert found["failed"] == found["wrong"] == pytest.approx(1 / 12)


def test_ours_is_charged_for_silence_where_the_other_speaks(flight, tracks):
    mine, theirs = on_common_frames(without_poses(tracks["map"], slice(0, 3)), tracks["epnp"], flight)
    assert mine["translation_m"] > 0.25 * 3 / 12 * 950.0
    silent, _ = on_common_frames(tracks["map"], without_poses(tracks["epnp"], slice(0, 11)), flight)
    last = np.linalg.norm(tracks["map"].T_camera_target[11, :3, 3] - flight.T_true[11, :3, 3])
    assert silent["translation_m"] == pytest.approx(last)
    assert theirs["model_m"] == pytest.approx(score(tracks["epnp"], flight)["model_before_m"])


def test_a_pair_that_is_better_everywhere():
    rng = np.random.default_rng(0)
    theirs = 10.0 + rng.standard_normal(20)
    pair = paired((0.8 * theirs).tolist(), theirs.tolist())
    assert pair.ratio == pytest.approx(0.8)
    assert pair.low == pytest.approx(0.8)
    assert pair.high == pytest.approx(0.8)
    assert pair.worse == 0.0
    assert not pair.is_worse


def test_a_pair_that_is_worse():
    rng = np.random.default_rng(0)
    theirs = 10.0 + rng.standard_normal(20)
    pair = paired((theirs + 1.0 + rng.standard_normal(20)).tolist(), theirs.tolist())
    assert pair.is_worse
    assert 0.5 < pair.worse <= 1.0


def test_a_seed_without_a_number_counts_as_worse():
    assert paired([np.nan, 1.0], [2.0, 2.0]).worse == 0.5
    assert np.isnan(paired([1.0, 1.0], [np.nan, np.nan]).worse)


def test_the_interval_is_that_of_the_mean():
    values = np.random.default_rng(1).normal(5.0, 1.0, 50)
    found = summarise([{"error": float(value)} for value in values])
    assert found["seeds"] == 50
    half = 1.96 * values.std() / np.sqrt(50)
    assert found["error_low95"] == pytest.approx(values.mean() - half, abs=0.1)
    assert found["error_high95"] == pytest.approx(values.mean() + half, abs=0.1)


def test_baselines_get_no_landmark_that_looks_doubtful():
    sigma = np.array([1.0, 1.1, 0.9, 1.0, 9.0, 1.0, 1.2, np.nan])
    view = View(
        frame=0,
        stamp_ns=0,
        landmarks=tuple("abcdefgh"),
        pixels=np.zeros((8, 2)),
        covariances=sigma[:, None, None] ** 2 * np.eye(2),
    )
    assert confident_view(view).landmarks == ("a", "b", "c", "d", "f", "g")
    few = View(frame=0, stamp_ns=0, landmarks=("a", "b"), pixels=np.zeros((2, 2)), covariances=view.covariances[3:5])
    assert confident_view(few).landmarks == ("a", "b")


def test_every_method_speaks_of_the_same_frames(flight, tracks):
    assert {name: len(track.T_camera_target) for name, track in tracks.items()} == dict.fromkeys(tracks, 12)
    assert score(tracks["map"], flight)["model_m"] < score(tracks["map"], flight)["model_before_m"]
    assert np.isfinite(score(tracks["refine"], flight)["model_nees"])
    assert (tracks["window"].status == 0).all()  # twelve views fill no window of twenty
