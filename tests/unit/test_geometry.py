# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Rigid motions and alignment against hand-computed cases; laws are in tests/property."""

import numpy as np
import pytest

from fairlead import geometry


def test_exp_of_a_quarter_turn() -> None:
    T = geometry.exp_se3(np.array([np.pi / 2, 0.0, 0.0, 0.0, 0.0, np.pi / 2]))
    # a quarter turn about z while walking a quarter circle of radius 1: ends at (1, 1)
    assert np.allclose(T[:3, :3], [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-15)
    assert np.allclose(T[:3, 3], [1.0, 1.0, 0.0], atol=1e-15)


def test_the_perturbation_acts_on_the_right_translation_first() -> None:
    T = np.eye(4)
    T[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    moved = geometry.perturb(T, np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    assert np.allclose(moved[:3, 3], [0.0, 1.0, 0.0])  # target axes: x of the target is y of the camera
    assert np.allclose(geometry.difference(T, moved), [1.0, 0.0, 0.0, 0.0, 0.0, 0.0])


def test_quaternion_order_is_xyzw_and_w_is_not_negative() -> None:
    half = np.sqrt(0.5)
    R = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    assert np.allclose(geometry.quat_xyzw_from_matrix(R), [0.0, 0.0, half, half])
    assert np.allclose(geometry.matrix_from_quat_xyzw(np.array([0.0, 0.0, -3.0, -3.0])), R)
    for axis in range(3):  # half turns: w = 0, the branch of the largest component
        quat = np.zeros(4)
        quat[axis] = 1.0
        turned = geometry.matrix_from_quat_xyzw(quat)
        assert np.allclose(np.abs(geometry.quat_xyzw_from_matrix(turned)), quat)
        assert np.isclose(np.linalg.norm(geometry.log_so3(turned)), np.pi)


@pytest.mark.parametrize("bad", [np.zeros(4), np.full(4, np.nan), np.array([np.inf, 0.0, 0.0, 1.0])])
def test_a_quaternion_without_direction_is_refused(bad: np.ndarray) -> None:
    with pytest.raises(ValueError, match="norm"):
        geometry.matrix_from_quat_xyzw(bad)


def test_adjoint_moves_a_perturbation_through_a_pose() -> None:
    T = geometry.exp_se3(np.array([1.0, -2.0, 3.0, 0.3, -0.8, 0.5]))
    xi = np.array([0.1, 0.2, -0.3, 0.05, -0.02, 0.04])
    assert np.allclose(T @ geometry.exp_se3(xi), geometry.exp_se3(geometry.adjoint(T) @ xi) @ T, atol=1e-14)


def test_alignment_never_reflects() -> None:
    axes = np.diag([3.0, 2.0, 1.0])
    points = np.concatenate([axes, -axes])
    mirrored = points * [1.0, 1.0, -1.0]
    found = geometry.align_similarity(mirrored, points)
    # best without reflection: leave the thinnest axis the wrong way round, scale (9 + 4 - 1) / (9 + 4 + 1)
    assert np.allclose(found.R_a_b, np.eye(3), atol=1e-12)
    assert np.isclose(found.scale, 12.0 / 14.0)


def test_alignment_of_a_plane_and_its_scale() -> None:
    rng = np.random.default_rng(2)
    points = rng.normal(size=(6, 3)) * [1.0, 1.0, 0.0]
    T = geometry.exp_se3(np.array([3.0, 2.0, 1.0, 0.4, 0.5, -0.6]))
    moved = geometry.transform(T, 2.5 * points)
    similar = geometry.align_similarity(moved, points)
    assert np.isclose(similar.scale, 2.5)
    assert np.allclose(similar.apply(points), moved, atol=1e-13)
    assert geometry.align_rigid(moved, points).scale == 1.0


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (np.zeros((2, 3)), "n >= 3"),
        (np.zeros((4, 3)), "line"),
        (np.arange(12.0).reshape(4, 3), "line"),
        (np.full((4, 3), np.nan), "finite"),
    ],
)
def test_alignment_says_what_it_cannot_do(points: np.ndarray, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        geometry.align_rigid(points, points)
