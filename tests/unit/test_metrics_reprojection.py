# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""docs/metrics.md eq. (11)-(13), computed by hand."""

import math

import numpy as np
import pytest

from fairlead.evaluate.reprojection import reproject
from fairlead.types import Camera, Estimate, View

CAMERA = Camera(
    name="c",
    width=100,
    height=100,
    model="pinhole",
    K=np.array([[100.0, 0, 50], [0, 100.0, 50], [0, 0, 1]]),
    distortion=np.zeros(0),
)
# At 10 m in front of the camera 1 m is 10 px.
X = np.array([[0.0, 0, 0], [1.0, 0, 0], [0.0, 1, 0], [1.0, 1, 0], [2.0, 1, 0]])
Z = np.array([[50.0, 50], [60, 50], [50, 60], [60, 60], [70, 60]])
NAMES = tuple("abcde")


def estimate(frame: int = 0, *, ok: bool = True, depth: float = 10.0) -> Estimate:
    T = np.eye(4)
    T[2, 3] = depth
    return Estimate(
        frame=frame,
        stamp_ns=frame,
        status="tracking" if ok else "lost",
        reason="",
        T_camera_target=T if ok else np.full((4, 4), np.nan),
        covariance=np.eye(6) if ok else np.full((6, 6), np.nan),
        n_inliers=0,
        reprojection_rms_px=0.0,
        information_gained=0.0,
        reset_counter=0,
        inliers=(),
    )


def view(offsets: np.ndarray, S: np.ndarray | None = None, frame: int = 0, names: str = "abcde") -> View:
    S = 4.0 * np.eye(2) if S is None else S
    n = len(offsets)
    return View(
        frame=frame,
        stamp_ns=frame,
        landmarks=tuple(names),
        pixels=Z[:n] + offsets,
        covariances=np.broadcast_to(S, (n, 2, 2)),
    )


def test_eq_11_is_a_distance_per_point() -> None:
    offsets = np.zeros((5, 2))
    offsets[1] = [3.0, -4.0]
    found = reproject([view(offsets)], [estimate()], CAMERA, NAMES, [X])
    assert found is not None
    assert found.errors_px == pytest.approx(np.array([0, 5.0, 0, 0, 0]))
    assert found.summary.rms == pytest.approx(5.0 / math.sqrt(5.0))
    assert found.per_frame_px == pytest.approx(np.array([math.sqrt(5.0)]))


def test_normalised_residual_eq_12() -> None:
    offsets = np.zeros((5, 2))
    offsets[0] = [-3.0, -4.0]
    found = reproject([view(offsets)], [estimate()], CAMERA, NAMES, [X])
    assert found is not None
    assert found.normalised[0] == pytest.approx([1.5, 2.0])  # r = projection - observation
    # 5 points, one pose: 2 x 5 - 6 = 4 dof; sum d^2 = 6.25.
    assert found.nis[0] == pytest.approx(6.25 / 4.0)
    assert found.noise_factor == pytest.approx(math.sqrt(6.25 / 4.0))


def test_correlated_noise_is_whitened() -> None:
    S = np.array([[2.0, 1.0], [1.0, 3.0]])
    offsets = np.tile([1.0, -2.0], (5, 1))
    found = reproject([view(offsets, S)], [estimate()], CAMERA, NAMES, [X])
    assert found is not None
    r = np.array([-1.0, 2.0])
    assert np.sum(found.normalised**2, axis=1) == pytest.approx(np.full(5, r @ np.linalg.solve(S, r)))


def test_robust_factor_eq_13_is_not_moved_by_an_outlier() -> None:
    # d^2 = 2 ln 2 = 1.386 for four of five points: the factor is sqrt(10 / 4), the loss of the pose's 6 dof.
    distance = 2.0 * math.sqrt(2.0 * math.log(2.0))
    offsets = np.tile([distance, 0.0], (5, 1))
    offsets[2] = [500.0, 0.0]
    found = reproject([view(offsets)], [estimate()], CAMERA, NAMES, [X])
    assert found is not None
    assert found.robust_noise_factor == pytest.approx(math.sqrt(10.0 / 4.0))
    assert found.noise_factor > 100.0
    assert found.outlier_share == pytest.approx(0.2)
    assert found.rms_in_gate_px == pytest.approx(distance)


def test_what_cannot_be_used_is_dropped_and_counted() -> None:
    offsets = np.zeros((5, 2))
    offsets[0] = np.nan
    covariances = np.broadcast_to(np.eye(2), (5, 2, 2)).copy()
    covariances[1] = [[1.0, 2.0], [2.0, 1.0]]
    covariances[2] = np.inf
    damaged = View(
        frame=0, stamp_ns=0, landmarks=("a", "b", "c", "ghost", "e"), pixels=Z + offsets, covariances=covariances
    )
    found = reproject([damaged], [estimate()], CAMERA, NAMES, [X])
    assert found is not None
    assert found.errors_px == pytest.approx(np.zeros(1))
    assert found.n_dropped == 4
    assert np.isnan(found.nis).all()  # one point cannot contradict a pose
    assert math.isnan(found.noise_factor)


def test_a_landmark_behind_the_camera_is_an_infinite_error() -> None:
    found = reproject([view(np.zeros((5, 2)))], [estimate(depth=-10.0)], CAMERA, NAMES, [X])
    assert found is not None
    assert np.isinf(found.errors_px).all()
    assert found.outlier_share == 1.0


def test_only_frames_with_a_pose_and_a_view_count() -> None:
    views = [view(np.zeros((5, 2)), frame=0), view(np.ones((5, 2)), frame=2)]
    found = reproject(views, [estimate(0), estimate(1), estimate(2, ok=False)], CAMERA, NAMES, [X] * 3)
    assert found is not None
    assert found.frames.tolist() == [0] * 5
    assert found.per_frame_px == pytest.approx(np.array([0.0, np.nan, np.nan]), nan_ok=True)
    assert reproject(views, [estimate(1)], CAMERA, NAMES, [X]) is None


def test_each_frame_is_judged_on_its_own_model() -> None:
    shifted = X + np.array([0.1, 0, 0])
    views = [view(np.zeros((5, 2)), frame=0), view(np.zeros((5, 2)), frame=1)]
    found = reproject(views, [estimate(0), estimate(1)], CAMERA, NAMES, [X, shifted])
    assert found is not None
    assert found.per_frame_px == pytest.approx(np.array([0.0, 1.0]))
