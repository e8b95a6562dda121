# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""docs/metrics.md eq. (8)-(10), (21), computed by hand; the gauge is taken out of model and poses alike."""

import math

import numpy as np
import pytest

from fairlead import geometry
from fairlead.evaluate.alignment import align_poses
from fairlead.evaluate.landmarks import landmark_errors, model_change, model_errors
from fairlead.evaluate.pose_errors import pose_errors
from fairlead.types import Camera, Target

SQUARE = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]])
TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def target(positions: np.ndarray, names: str = "abcd", covariance: np.ndarray | None = None) -> Target:
    n = len(positions)
    P = np.eye(3 * n) if covariance is None else covariance
    return Target(name="t", landmarks=tuple(names), positions=positions, covariance=P)


def test_raw_eq_10() -> None:
    moved = SQUARE.copy()
    moved[1] += [0.0, 3.0, 4.0]
    errors = landmark_errors(target(moved), target(SQUARE), "raw")
    assert errors is not None
    assert errors.errors_m.tolist() == [0.0, 5.0, 0.0, 0.0]
    assert errors.summary.rms == 2.5
    assert (errors.scale, errors.rotation_deg, errors.shift_m) == (1.0, 0.0, 0.0)


def test_a_motion_is_gone_after_se3_eq_8() -> None:
    errors = landmark_errors(target(SQUARE @ TURN.T + [5.0, 0.0, 0.0]), target(SQUARE), "se3")
    assert errors is not None
    assert errors.errors_m == pytest.approx(np.zeros(4), abs=1e-12)
    assert errors.rotation_deg == pytest.approx(90.0)
    # The centroid (1, 1) went to (-1, 1) + (5, 0) = (4, 1): 3 m.
    assert errors.shift_m == pytest.approx(3.0)


def test_a_scale_stays_after_se3_and_is_gone_after_sim3() -> None:
    errors = model_errors(target(1.5 * SQUARE), target(SQUARE))
    assert errors is not None
    assert errors.se3 is not None
    assert errors.sim3 is not None
    assert errors.se3.errors_m == pytest.approx(np.full(4, 0.5 * math.sqrt(2.0)))
    assert errors.sim3.errors_m == pytest.approx(np.zeros(4), abs=1e-12)
    assert errors.sim3.scale == pytest.approx(1.0 / 1.5)


def test_landmarks_are_matched_by_name() -> None:
    estimated = target(SQUARE[::-1].copy(), names="dcba")
    true = target(np.vstack([SQUARE, [[9.0, 9.0, 9.0]]]), names="abcde")
    errors = landmark_errors(estimated, true, "raw")
    assert errors is not None
    assert errors.names == ("d", "c", "b", "a")
    assert errors.summary.maximum == 0.0


def test_what_does_not_determine_the_alignment_is_none() -> None:
    line = np.array([[0.0, 0, 0], [1.0, 0, 0], [2.0, 0, 0], [3.0, 0, 0]])
    errors = model_errors(target(line), target(line))
    assert errors is not None
    assert errors.se3 is None
    assert errors.sim3 is None
    assert model_errors(target(SQUARE), target(SQUARE, names="wxyz")) is None


def test_aligned_poses_see_the_same_image_eq_9() -> None:
    rng = np.random.default_rng(3)
    S = geometry.Similarity(scale=1.7, R_a_b=geometry.exp_so3(np.array([0.3, -0.2, 0.5])), t_a_b=np.array([1.0, 2, 3]))
    T = geometry.exp_se3(np.array([0.2, 0.1, 12.0, 0.1, 0.2, 0.3]))
    X = rng.normal(size=(7, 3))
    camera = Camera(name="c", width=9, height=9, model="pinhole", K=np.eye(3), distortion=np.zeros(0))
    moved = align_poses(T[None], S)[0]
    before = geometry.project(camera, geometry.transform(T, X))
    after = geometry.project(camera, geometry.transform(moved, S.apply(X)))
    assert after == pytest.approx(before, abs=1e-12)
    assert geometry.transform(moved, S.apply(X)) == pytest.approx(1.7 * geometry.transform(T, X))


def test_an_error_of_the_gauge_alone_vanishes_from_model_and_poses() -> None:
    g = geometry.exp_se3(np.array([0.3, -0.1, 0.2, 0.05, -0.04, 0.1]))
    T_true = np.array([geometry.exp_se3(np.array([0.0, 0.1 * k, 20.0, 0.1, 0.2 * k, 0.0])) for k in range(4)])
    X = np.vstack([SQUARE, [[0.5, 0.5, 1.0]]])
    estimated, true = target(geometry.transform(g, X), "abcde"), target(X, "abcde")
    T = T_true @ geometry.inverse(g)
    errors = model_errors(estimated, true)
    assert errors is not None
    assert errors.se3 is not None
    assert pose_errors(T, T_true).rotation_deg.summary.mean == pytest.approx(
        math.degrees(np.linalg.norm([0.05, -0.04, 0.1]))
    )
    aligned = pose_errors(T, T_true, errors.se3.similarity)
    assert aligned.rotation_deg.summary.maximum < 1e-9
    assert aligned.translation_m.summary.maximum < 1e-9
    assert aligned.position_m.summary.maximum < 1e-9


def test_poses_that_do_not_exist_stay_nan() -> None:
    S = geometry.Similarity(scale=2.0, R_a_b=np.eye(3), t_a_b=np.ones(3))
    assert np.isnan(align_poses(np.full((1, 4, 4), np.nan), S)[0, :3]).all()


def test_prior_factor_eq_21() -> None:
    # P0 = I, P = I / 2: tr(P0^-1 (P0 - P)) = 6; d^T P0^-1 d = 12 x 0.5 at d = sqrt(1/2) each, so the factor is 1.
    before = target(SQUARE)
    after = target(SQUARE + math.sqrt(0.5), covariance=0.5 * np.eye(12))
    change = model_change(before, after)
    assert change is not None
    assert change.prior_factor == pytest.approx(1.0)
    assert change.shifts_m == pytest.approx(np.full(4, math.sqrt(1.5)))
    assert change.sigma_before_m == 1.0
    assert change.sigma_after_m == pytest.approx(math.sqrt(0.5))
    thrice = model_change(before, target(SQUARE + 3.0 * math.sqrt(0.5), covariance=0.5 * np.eye(12)))
    assert thrice is not None
    assert thrice.prior_factor == pytest.approx(3.0)


def test_prior_factor_is_none_where_the_data_told_nothing() -> None:
    change = model_change(target(SQUARE), target(SQUARE))
    assert change is not None
    assert change.prior_factor is None
    exact = target(SQUARE, covariance=np.zeros((12, 12)))
    unchanged = model_change(exact, exact)
    assert unchanged is not None
    assert unchanged.prior_factor is None
