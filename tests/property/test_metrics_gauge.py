# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Errors without gauge do not depend on the frame and scale of the estimate: docs/metrics.md eq. (8)-(10)."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from fairlead import geometry
from fairlead.evaluate.alignment import align_poses
from fairlead.evaluate.landmarks import landmark_errors
from fairlead.evaluate.pose_errors import pose_errors
from fairlead.types import Target

component = st.floats(-2.0, 2.0)


def target(positions: np.ndarray) -> Target:
    n = len(positions)
    return Target(name="t", landmarks=tuple(map(str, range(n))), positions=positions, covariance=np.eye(3 * n))


@given(xi=st.tuples(*[component] * 6), scale=st.floats(0.2, 5.0), seed=st.integers(0, 2**16))
def test_a_similarity_of_the_estimate_changes_no_aligned_error(xi: tuple[float, ...], scale: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    X_true = rng.normal(size=(6, 3))
    X = X_true + 0.05 * rng.normal(size=X_true.shape)
    T_true = np.array([geometry.exp_se3(np.array([0, 0, 10.0, *rng.normal(size=3)])) for _ in range(3)])
    T = np.array([geometry.perturb(each, 0.02 * rng.normal(size=6)) for each in T_true])
    g = geometry.exp_se3(np.array(xi))
    S = geometry.Similarity(scale=scale, R_a_b=g[:3, :3], t_a_b=g[:3, 3])
    plain = landmark_errors(target(X), target(X_true), "sim3")
    moved = landmark_errors(target(S.apply(X)), target(X_true), "sim3")
    assert plain is not None
    assert moved is not None
    # Rounding: positions of a few metres, scales up to 5, poses at 10 m.
    np.testing.assert_allclose(moved.errors_m, plain.errors_m, atol=1e-9)
    before = pose_errors(T, T_true, plain.similarity)
    after = pose_errors(align_poses(T, S), T_true, moved.similarity)
    np.testing.assert_allclose(after.rotation_deg.values, before.rotation_deg.values, atol=1e-6)
    np.testing.assert_allclose(after.translation_m.values, before.translation_m.values, atol=1e-8)
    np.testing.assert_allclose(after.position_m.values, before.position_m.values, atol=1e-8)


@given(xi=st.tuples(*[component] * 6), seed=st.integers(0, 2**16))
def test_errors_do_not_depend_on_the_axes_of_the_camera(xi: tuple[float, ...], seed: int) -> None:
    """A rotation of both camera frames changes neither rotation, translation nor position error."""
    rng = np.random.default_rng(seed)
    T_true = np.array([geometry.exp_se3(rng.normal(size=6)) for _ in range(3)])
    T = np.array([geometry.perturb(each, 0.1 * rng.normal(size=6)) for each in T_true])
    turn = np.eye(4)
    turn[:3, :3] = geometry.exp_so3(np.array(xi[:3]))
    plain, turned = pose_errors(T, T_true), pose_errors(turn @ T, turn @ T_true)
    np.testing.assert_allclose(turned.rotation_deg.values, plain.rotation_deg.values, atol=1e-7)
    np.testing.assert_allclose(turned.translation_m.values, plain.translation_m.values, atol=1e-10)
    np.testing.assert_allclose(turned.position_m.values, plain.position_m.values, atol=1e-10)
