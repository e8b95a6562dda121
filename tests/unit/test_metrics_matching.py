# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""docs/metrics.md section 1: which frames are judged."""

import numpy as np
import pytest

from fairlead.evaluate.matching import match_by_stamp
from fairlead.types import Estimate, TruthPose


def estimate(frame: int, stamp_ns: int) -> Estimate:
    return Estimate(
        frame=frame,
        stamp_ns=stamp_ns,
        status="tracking",
        reason="",
        T_camera_target=np.eye(4),
        covariance=np.eye(6),
        n_inliers=0,
        reprojection_rms_px=0.0,
        information_gained=0.0,
        reset_counter=0,
        inliers=(),
    )


def truth(frame: int, stamp_ns: int) -> TruthPose:
    return TruthPose(frame=frame, stamp_ns=stamp_ns, T_camera_target=np.eye(4))


def test_truth_of_a_part_of_the_frames() -> None:
    matching = match_by_stamp([truth(1, 100), truth(3, 300)], [estimate(k, 100 * k) for k in range(4)])
    assert matching.pairs == ((0, 1), (1, 3))
    assert (matching.n_matched, matching.n_truth, matching.n_estimates, matching.n_by_nearest) == (2, 2, 4, 0)


def test_nearest_within_the_tolerance_closest_pairs_first() -> None:
    estimates = [estimate(0, 1000), estimate(1, 2000)]
    matching = match_by_stamp([truth(0, 1400), truth(1, 1990), truth(2, 9999)], estimates, tolerance_ns=1000)
    assert matching.pairs == ((0, 0), (1, 1))
    assert (matching.n_by_nearest, matching.largest_offset_ns, matching.n_truth_left_over) == (2, 400, 1)


def test_the_closer_of_two_true_poses_gets_the_frame_whatever_their_order() -> None:
    for order in ([1400, 1100], [1100, 1400]):
        matching = match_by_stamp([truth(9, stamp) for stamp in order], [estimate(0, 1000)], tolerance_ns=1000)
        assert matching.pairs == ((order.index(1100), 0),)


def test_outside_the_tolerance_nothing_matches() -> None:
    assert match_by_stamp([truth(0, 0)], [estimate(0, 11)], tolerance_ns=10).n_matched == 0
    assert match_by_stamp([truth(0, 0)], [estimate(0, 10)], tolerance_ns=10).n_matched == 1


def test_stamps_of_today_are_compared_as_whole_nanoseconds() -> None:
    now = 1_800_000_000_000_000_001  # a float64 has steps of 256 ns here
    matching = match_by_stamp([truth(0, now + 1)], [estimate(7, now), estimate(8, now + 2)], tolerance_ns=0)
    assert matching.n_matched == 0
    matching = match_by_stamp([truth(0, now + 1)], [estimate(7, now), estimate(8, now + 3)], tolerance_ns=5)
    assert matching.pairs == ((0, 0),)
    assert matching.largest_offset_ns == 1


def test_each_is_used_once() -> None:
    matching = match_by_stamp([truth(0, 5), truth(1, 5)], [estimate(0, 5), estimate(9, 6)], tolerance_ns=3)
    assert sorted(matching.pairs) == [(0, 0), (1, 1)]


def test_images_without_stamps_are_told_apart_by_their_number() -> None:
    matching = match_by_stamp([truth(2, 0), truth(0, 0)], [estimate(0, 0), estimate(1, 0), estimate(2, 0)])
    assert matching.pairs == ((1, 0), (0, 2))


def test_a_negative_tolerance_is_refused() -> None:
    with pytest.raises(ValueError, match="tolerance_ns: expected >= 0, got -1"):
        match_by_stamp([], [], tolerance_ns=-1)
