# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from benchmarks.scoring import Answer, pose_errors, score
from fairlead.geometry import exp_se3, exp_so3


def pose(R, t):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, t
    return T


def test_pose_error_by_hand():
    """A quarter turn about z: the camera's +x error of 2 m is along the target's R^T x = (0, -1, 0)."""
    R = exp_so3(np.array([0.0, 0.0, np.pi / 2]))
    true, estimated = pose(R, [2.0, 0.0, 50.0]), pose(R, [0.0, 0.0, 50.0])
    np.testing.assert_allclose(pose_errors(estimated[None], true[None]), [[0, -2, 0, 0, 0, 0]], atol=1e-12)


def test_pose_error_is_xi_to_first_order():
    """T_true = T_est Exp(xi): the error is xi up to |xi|^2."""
    rng = np.random.default_rng(0)
    T = exp_se3(rng.normal(size=6))
    xi = 1e-5 * rng.normal(size=6)
    np.testing.assert_allclose(pose_errors(T[None], (T @ exp_se3(xi))[None])[0], xi, atol=1e-9)


def test_scores_by_hand():
    """3 degrees and 4 m off in view 0, no pose in view 1; landmarks 1 m and 2 m off."""
    true = np.stack([pose(np.eye(3), [0, 0, 100.0])] * 2)
    estimated = np.stack([pose(exp_so3(np.radians([0.0, 3.0, 0.0])), [0.0, 0.0, 104.0]), np.full((4, 4), np.nan)])
    X = np.zeros((2, 3))
    answer = Answer(
        T=estimated,
        X=np.array([[1.0, 0, 0], [0, 2.0, 0]]),
        pose_covariances=np.stack([np.diag([4.0, 4, 4, 1, 1, 1]), np.full((6, 6), np.nan)]),
        landmark_covariance=4.0 * np.eye(6),
    )
    scores = score(answer, true, X)
    assert scores.rotation_deg[0] == pytest.approx(3.0)
    assert scores.translation_m[0] == pytest.approx(4.0)
    assert np.isnan(scores.rotation_deg[1])
    assert np.isnan(scores.pose_nees[1])
    assert scores.pose_nees[0] == pytest.approx(16 / 4 + np.radians(3.0) ** 2)
    assert scores.landmark_nees == pytest.approx(5 / 4)
    np.testing.assert_allclose(scores.landmark_m, [1.0, 2.0])
