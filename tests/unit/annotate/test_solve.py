# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Hand truth against the bound, single frames against all jointly, and clicks that are wrong."""

from collections.abc import Sequence

import numpy as np
import pytest

from fairlead.annotate.labels import Labels, Mark
from fairlead.annotate.solve import FrameSolution, solve_frame, solve_jointly, view_of
from fairlead.geometry import difference
from fairlead.types import View
from reference.bound import Bound, bayesian_bound
from reference.cameras import make_projection
from tests.unit.annotate.conftest import Scene

SEEDS = 8


def views_of(labels: Labels) -> list[View]:
    return [view_of(labels, frame, 10**9 * frame) for frame in sorted(labels.frames)]


def errors(scene: Scene, solutions: Sequence[FrameSolution]) -> np.ndarray:
    """(k, 6): xi with truth = estimate Exp(xi); every frame has a pose."""
    assert all(each.estimate.ok for each in solutions)
    pairs = zip(solutions, scene.T_camera_target, strict=True)
    return np.array([difference(each.estimate.T_camera_target, T) for each, T in pairs])


def bound_of(scene: Scene, sigma_m: float, noise_px: float = 1.0) -> Bound:
    S = np.where(scene.seen()[..., None, None], noise_px**2 * np.eye(2), np.inf)
    camera = scene.camera
    projection = make_projection("pinhole", camera.K, np.empty(0))
    P0 = sigma_m**2 * np.eye(3 * len(scene.target.landmarks))
    return bayesian_bound(projection, scene.target.positions, P0, scene.T_camera_target, S)


def rms(xi: np.ndarray) -> np.ndarray:
    """Of translation [m] and rotation [rad]."""
    return np.sqrt(np.mean(xi[..., :3] ** 2) * 3.0), np.sqrt(np.mean(xi[..., 3:] ** 2) * 3.0)


def without_gauge(scene: Scene, xi: np.ndarray) -> np.ndarray:
    """What is left when one rigid motion and one growth of the target frame are taken out, CONVENTIONS.md eq. (8)."""
    columns = [
        np.hstack([-np.eye(6), np.r_[T[:3, :3].T @ T[:3, 3], np.zeros(3)][:, None]]) for T in scene.T_camera_target
    ]
    # Rotations are weighted so that both count: a radian moves the landmarks by the radius of the target.
    weight = np.tile(np.r_[np.ones(3), np.full(3, 6.0)], len(xi))
    G = np.concatenate(columns) * weight[:, None]
    flat = xi.ravel() * weight
    return ((flat - G @ np.linalg.lstsq(G, flat, rcond=None)[0]) / weight).reshape(xi.shape)


def test_clicks_with_one_pixel_of_noise_give_truth_at_the_bound(scene: Scene) -> None:
    found = []
    for seed in range(SEEDS):
        labels = scene.labels(np.random.default_rng(seed))
        found.append(errors(scene, [solve_frame(labels, view, scene.camera) for view in views_of(labels)]))
    bound = bound_of(scene, 0.0)
    translation, rotation = rms(np.array(found))
    assert translation <= 1.2 * np.sqrt(bound.translation_variances.mean())
    assert rotation <= 1.2 * np.sqrt(bound.rotation_variances.mean())


def test_the_covariance_of_a_click_solution_is_true(scene: Scene) -> None:
    squares = []
    for seed in range(SEEDS):
        labels = scene.labels(np.random.default_rng(100 + seed))
        solutions = [solve_frame(labels, view, scene.camera) for view in views_of(labels)]
        for xi, each in zip(errors(scene, solutions), solutions, strict=True):
            squares.append(xi @ np.linalg.solve(each.estimate.covariance, xi))
    # 160 x 6 squares of unit normals: their mean is 6 +- 0.27 (1 sigma); the noise itself is estimated, hence wider.
    assert 4.8 < np.mean(squares) < 7.6


def test_joint_solving_halves_the_error_of_rough_landmarks(scene: Scene) -> None:
    single, joint = [], []
    for seed in range(SEEDS):
        labels = scene.labels(np.random.default_rng(seed), sigma_m=0.2)
        views = views_of(labels)
        single.append(errors(scene, [solve_frame(labels, view, scene.camera) for view in views]))
        solved = solve_jointly(labels, views, scene.camera)
        joint.append(errors(scene, [solved.solutions[view.frame] for view in views]))
    # The frame and the size of the target are the prior's, whatever is solved: against the bound they count ...
    bound = bound_of(scene, 0.2)
    translation, rotation = rms(np.array(joint))
    assert translation <= 1.25 * np.sqrt(bound.translation_variances.mean())
    assert rotation <= 1.25 * np.sqrt(bound.rotation_variances.mean())
    # ... and beside single frames they are taken out of both.
    before = rms(np.array([without_gauge(scene, xi) for xi in single]))
    after = rms(np.array([without_gauge(scene, xi) for xi in joint]))
    assert after[0] <= 0.5 * before[0]
    assert after[1] <= 0.5 * before[1]


def test_with_exact_landmarks_joint_solving_changes_nothing(scene: Scene) -> None:
    labels = scene.labels(np.random.default_rng(3))
    views = views_of(labels)
    solved = solve_jointly(labels, views, scene.camera, revision=7)
    assert solved.revision == 7
    np.testing.assert_allclose(solved.refinement.model.positions, scene.target.positions, atol=1e-6)
    for view in views:
        alone = solve_frame(labels, view, scene.camera).estimate.T_camera_target
        xi = difference(alone, solved.solutions[view.frame].estimate.T_camera_target)
        assert np.abs(xi[:3]).max() < 0.1  # less than its own sigma of 0.09 m: only the noise factor differs


@pytest.mark.parametrize("off_px", [15.0, 200.0])
@pytest.mark.parametrize("count", [6, 10])
def test_a_bad_click_is_named(scene: Scene, off_px: float, count: int) -> None:
    labels = scene.labels(np.random.default_rng(0), sigma_m=0.02)
    marks = dict(list(labels.frames[3].items())[:count])
    bad = list(marks)[1]
    marks[bad] = Mark(u_px=marks[bad].u_px + 0.6 * off_px, v_px=marks[bad].v_px + 0.8 * off_px)
    wrong = Labels(landmarks=labels.landmarks, frames={3: marks})
    solved = solve_frame(wrong, view_of(wrong, 3, 0), scene.camera)
    assert [each.number for each in solved.warnings] == [bad]
    assert scene.target.landmarks[bad] in solved.warnings[0].text
    # The pose is that of the good clicks: the landmark is where it was before the bad click, to a few pixels.
    assert np.hypot(*solved.residuals[bad]) == pytest.approx(off_px, abs=6.0)


def test_two_swapped_clicks_are_named_for_what_they_are(scene: Scene) -> None:
    labels = scene.labels(np.random.default_rng(0))
    marks = dict(labels.frames[3])
    a, b = list(marks)[1], list(marks)[2]
    marks[a], marks[b] = marks[b], marks[a]
    wrong = Labels(landmarks=labels.landmarks, frames={3: marks})
    texts = [each.text for each in solve_frame(wrong, view_of(wrong, 3, 0), scene.camera).warnings]
    names = scene.target.landmarks
    assert len(texts) == 2
    assert any(text.startswith(names[a]) and text.endswith(f"is it {names[b]}?") for text in texts)
    assert any(text.startswith(names[b]) and text.endswith(f"is it {names[a]}?") for text in texts)


def test_a_landmark_that_the_mesh_hides_is_named(scene: Scene) -> None:
    labels = scene.labels(np.random.default_rng(0))
    hidden = int(np.flatnonzero(~scene.seen()[3])[0])
    u, v = scene.pixels()[3, hidden]
    marks = {**labels.frames[3], hidden: Mark(u_px=float(u), v_px=float(v))}
    wrong = Labels(landmarks=labels.landmarks, frames={3: marks})
    solved = solve_frame(wrong, view_of(wrong, 3, 0), scene.camera, scene.surface)
    assert [each.number for each in solved.warnings] == [hidden]
    assert "hides it" in solved.warnings[0].text
    assert solved.in_sight == frozenset(np.flatnonzero(scene.seen()[3]).tolist())


def test_few_marks_give_no_pose_and_say_so(scene: Scene) -> None:
    labels = scene.labels(np.random.default_rng(0))
    marks = {**dict(list(labels.frames[0].items())[:3]), 17: Mark(hidden=True)}
    few = Labels(landmarks=labels.landmarks, frames={0: marks})
    solved = solve_frame(few, view_of(few, 0, 0), scene.camera)
    assert not solved.estimate.ok
    assert solved.warnings[0].text == "3 of at least 4 landmarks marked"
    with pytest.raises(ValueError, match="expected a frame with at least 4"):
        solve_jointly(few, views_of(few), scene.camera)
