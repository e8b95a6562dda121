# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Does the core answer in a study what it answers alone, with any number of threads, and is the bound the oracle's?"""

import numpy as np
import pytest

from fairlead.baselines.free_window import free_batch
from fairlead.simulate import Simulation, simulate_arc
from fairlead.study.block import Task, prepare, solve_each
from fairlead.study.methods import METHODS, Answers, Solver
from fairlead.study.settings import Setting
from fairlead.tracker import Tracker, refine
from reference.bound import bayesian_bound
from reference.cameras import make_projection

SETTING = Setting(sigma_px=1.0, views=5)
RUNS = (0, 1, 2)


@pytest.fixture(scope="module")
def answers(task: Task) -> dict[str, Answers]:
    return solve_each(task, prepare(task, SETTING, RUNS), threads=1)


@pytest.fixture(scope="module")
def flight(task: Task) -> Simulation:
    """Run 1 as `simulate_arc` gives it."""
    return simulate_arc(task.target, task.camera, SETTING.scenario, SETTING.generator(task.seed, 1))


def test_threads_change_nothing(task, answers):
    prepared = prepare(task, SETTING, RUNS)
    solver = Solver(prepared.block, prepared.T_epnp)
    for method in METHODS:
        again, first = solver.solve(method, 3), answers[method.name]
        np.testing.assert_array_equal(again.T_camera_target, first.T_camera_target)
        np.testing.assert_array_equal(again.covariances, first.covariances)
        np.testing.assert_array_equal(again.X, first.X)


def test_batch_is_refine(answers, flight):
    found = refine(flight.views, flight.target_told, flight.camera)
    mine = answers["map"]
    np.testing.assert_array_equal(mine.T_camera_target[1], [e.T_camera_target for e in found.estimates])
    np.testing.assert_array_equal(mine.covariances[1], [e.covariance for e in found.estimates])
    np.testing.assert_array_equal(mine.X[1], found.model.positions)
    assert mine.X_covariance is not None
    np.testing.assert_array_equal(mine.X_covariance[1], found.model.covariance)
    assert mine.iterations[1] == found.iterations


def test_online_is_the_tracker(answers, flight):
    tracker = Tracker(flight.target_told, flight.camera)
    estimates = [tracker.update(view) for view in flight.views]
    np.testing.assert_array_equal(answers["online"].T_camera_target[1], [e.T_camera_target for e in estimates])
    np.testing.assert_array_equal(answers["online"].X[1], tracker.model.positions)


def test_window_is_the_published_one(answers, flight):
    """Two implementations of docs/baselines.md section 3: single views minimised by OpenCV there, by the core here.

    OpenCV stops where a step changes the parameters by 1e-10 of their size: 1e-7 m at 1 km; flat directions amplify it.
    """
    found = free_batch(flight.views, flight.target_told, flight.camera)
    np.testing.assert_allclose(answers["window"].X[1], found.model.positions, atol=1e-3)
    T = np.stack([e.T_camera_target for e in found.estimates])
    np.testing.assert_allclose(answers["window"].T_camera_target[1], T, atol=1e-2)


def test_bound_is_the_oracle_s(task, answers):
    """Analytic against numerical Jacobians (1e-10), amplified by correlations up to 0.9999: 1e-4 of the variances."""
    prepared = prepare(task, SETTING, (0,))
    block, camera = prepared.block, task.camera
    bound = bayesian_bound(
        make_projection(camera.model, camera.K, camera.distortion), block.X_true, block.P0[0], block.T_true, np.eye(2)
    )
    mine = answers["bound"]
    assert mine.X_covariance is not None
    for ours, theirs in zip(
        [*mine.covariances[0], mine.X_covariance[0]], [*bound.pose_covariances, bound.landmark_covariance], strict=True
    ):
        sigma = np.sqrt(np.diag(theirs))
        assert np.abs((ours - theirs) / np.outer(sigma, sigma)).max() < 1e-4


def test_without_a_start_there_is_no_answer(task):
    prepared = prepare(task, SETTING, (0,))
    T = prepared.T_epnp.copy()
    T[0, 2] = np.nan
    solver = Solver(prepared.block, T)
    for method in METHODS:
        missing = np.isnan(solver.solve(method, 1).T_camera_target[0]).all(axis=(1, 2))
        needs_start = method.solver in ("start", "single_view", "free_window")
        assert missing.tolist() == [False, False, needs_start, False, False], method.name


def test_a_pixel_that_is_none_is_left_out(task):
    prepared = prepare(task, SETTING, (0,))
    prepared.block.pixels[0, :, 3] = np.nan
    solver = Solver(prepared.block, prepared.T_epnp)
    for method in METHODS:
        answers = solver.solve(method, 1)
        assert np.isfinite(answers.T_camera_target).all(), method.name
        if method.solver == "free_window":
            np.testing.assert_array_equal(answers.X[0, 3], prepared.block.X0[0, 3])
