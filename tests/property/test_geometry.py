# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Laws of the numpy geometry, for all inputs."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from fairlead import geometry

UNIT = 2.0**-52


def vectors(size: int, limit: float) -> st.SearchStrategy[np.ndarray]:
    return arrays(np.float64, size, elements=st.floats(-limit, limit, allow_subnormal=False))


@st.composite
def twists(draw: st.DrawFn) -> np.ndarray:
    """Translations to 100 m, rotations below pi."""
    phi = draw(vectors(3, 1.0))
    norm = float(np.linalg.norm(phi))
    angle = draw(st.floats(0.0, 3.14))
    return np.concatenate([draw(vectors(3, 100.0)), phi / norm * angle if norm > 1e-6 else phi])


@given(twists())
def test_log_inverts_exp(xi: np.ndarray) -> None:
    # near pi the translation passes V^-1, whose norm stays below 2; 1e3 covers the accumulated products
    assert np.allclose(geometry.log_se3(geometry.exp_se3(xi)), xi, rtol=0.0, atol=1e3 * UNIT * (1.0 + np.abs(xi).max()))


@given(twists(), twists(), twists())
def test_motions_are_a_group(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> None:
    A, B, C = geometry.exp_se3(a), geometry.exp_se3(b), geometry.exp_se3(c)
    scale = 1.0 + sum(float(np.abs(x).max()) for x in (a, b, c))
    assert np.allclose((A @ B) @ C, A @ (B @ C), rtol=0.0, atol=100 * UNIT * scale)
    assert np.allclose(A @ geometry.inverse(A), np.eye(4), rtol=0.0, atol=100 * UNIT * scale)
    R = A[:3, :3]
    assert np.allclose(R.T @ R, np.eye(3), atol=10 * UNIT)


@given(twists(), twists())
def test_difference_inverts_perturb(a: np.ndarray, xi: np.ndarray) -> None:
    T = geometry.exp_se3(a)
    scale = 1.0 + float(np.abs(a).max() + np.abs(xi).max())
    assert np.allclose(geometry.difference(T, geometry.perturb(T, xi)), xi, rtol=0.0, atol=1e4 * UNIT * scale)


@given(twists(), vectors(3, 10.0), twists())
def test_the_gauge_moves_every_pose_by_the_same_perturbation(g: np.ndarray, X: np.ndarray, a: np.ndarray) -> None:
    """X' = G X and T' = T inv(G) leave every camera point where it was."""
    G, T = geometry.exp_se3(g), geometry.exp_se3(a)
    before = geometry.transform(T, X[None])
    after = geometry.transform(T @ geometry.inverse(G), geometry.transform(G, X[None]))
    assert np.allclose(before, after, rtol=0.0, atol=1e3 * UNIT * (1.0 + np.abs(g).max() + np.abs(a).max()))


@given(vectors(4, 1.0).filter(lambda quat: float(np.linalg.norm(quat)) > 1e-3))
def test_quaternions_come_back(quat: np.ndarray) -> None:
    R = geometry.matrix_from_quat_xyzw(quat)
    again = geometry.quat_xyzw_from_matrix(R)
    assert again[3] >= 0.0
    unit = quat / np.linalg.norm(quat)
    assert min(np.abs(again - unit).max(), np.abs(again + unit).max()) < 100 * UNIT
    assert np.isclose(np.linalg.det(R), 1.0)


@given(
    arrays(np.float64, (8, 3), elements=st.floats(-10.0, 10.0, allow_subnormal=False)),
    twists(),
    st.floats(0.01, 100.0),
)
def test_alignment_finds_what_was_done(points: np.ndarray, xi: np.ndarray, scale: float) -> None:
    singular = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if singular[1] < 1e-3 * max(1.0, singular[0]):
        return
    moved = geometry.transform(geometry.exp_se3(xi), scale * points)
    found = geometry.align_similarity(moved, points)
    condition = (singular[0] / singular[1]) ** 2
    size = float(np.abs(moved).max()) + 1.0
    assert np.allclose(found.apply(points), moved, rtol=0.0, atol=1e3 * UNIT * condition * size)
    assert np.isclose(np.linalg.det(found.R_a_b), 1.0)
