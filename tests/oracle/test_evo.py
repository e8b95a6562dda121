# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""ATE and RPE against evo (docs/metrics.md eq. (22)-(23)): an independent program of the field."""

import numpy as np
import pytest

from fairlead import geometry
from fairlead.evaluate.trajectory import relative_errors, trajectory_errors

metrics = pytest.importorskip("evo.core.metrics")
trajectory = pytest.importorskip("evo.core.trajectory")


def flight(rng: np.random.Generator, n: int = 60) -> tuple[np.ndarray, np.ndarray]:
    """A descending arc and an estimate of it that is turned, scaled and noisy."""
    T_true, T = [], []
    gauge = geometry.exp_se3(np.array([2.0, -1.0, 3.0, 0.05, 0.1, -0.04]))
    for k in range(n):
        angle = 0.03 * k
        c = np.array([100.0 * np.cos(angle), 100.0 * np.sin(angle), 40.0 - 0.3 * k])
        T_target_camera = np.eye(4)
        T_target_camera[:3, :3] = geometry.exp_so3(np.array([0.1, 0.2, angle]))
        T_target_camera[:3, 3] = c
        T_k = geometry.inverse(T_target_camera)
        wrong = T_k.copy()
        wrong[:3, 3] *= 1.03
        T_true.append(T_k)
        T.append(geometry.perturb(wrong @ gauge, rng.normal(size=6) * np.array([0.3, 0.3, 0.3, 0.004, 0.004, 0.004])))
    return np.array(T), np.array(T_true)


def evo_paths(T: np.ndarray, T_true: np.ndarray):
    return tuple(trajectory.PosePath3D(poses_se3=list(np.linalg.inv(poses))) for poses in (T_true, T))


@pytest.mark.parametrize("with_scale", [None, False, True])
def test_ate(with_scale: bool | None) -> None:
    T, T_true = flight(np.random.default_rng(5))
    reference, estimated = evo_paths(T, T_true)
    if with_scale is not None:
        estimated.align(reference, correct_scale=with_scale)
    theirs = metrics.APE(metrics.PoseRelation.translation_part)
    theirs.process_data((reference, estimated))
    found = trajectory_errors(T, T_true)
    assert found is not None
    ours = {None: found.ate_m, False: found.ate_se3_m, True: found.ate_sim3_m}[with_scale]
    assert ours is not None
    for name, value in (("rmse", ours.rms), ("mean", ours.mean), ("median", ours.median), ("max", ours.maximum)):
        # Both are float64 on positions of 100 m: 1e-9 leaves room for the inverse of the poses.
        assert value == pytest.approx(theirs.get_all_statistics()[name], abs=1e-9)


def test_rpe() -> None:
    T, T_true = flight(np.random.default_rng(6))
    metres, degrees = relative_errors(T, T_true)
    for ours, relation in (
        (metres, metrics.PoseRelation.translation_part),
        (degrees, metrics.PoseRelation.rotation_angle_deg),
    ):
        theirs = metrics.RPE(relation, delta=1, delta_unit=metrics.Unit.frames, all_pairs=True)
        theirs.process_data(evo_paths(T, T_true))
        # evo takes its angle from the arc cosine: 1e-7 rad at small angles.
        assert ours == pytest.approx(np.asarray(theirs.error), abs=1e-5)


def test_a_straight_path_has_no_alignment_and_one_pose_no_motion() -> None:
    T_true = np.array([geometry.exp_se3(np.array([0.0, 0.0, 10.0 + k, 0, 0, 0])) for k in range(3)])
    found = trajectory_errors(T_true, T_true)
    assert found is not None
    assert found.ate_se3_m is None
    assert found.ate_m.maximum == 0.0
    single = trajectory_errors(T_true[:1], T_true[:1])
    assert single is not None
    assert single.rpe_m is None
    assert trajectory_errors(T_true[:0], T_true[:0]) is None
