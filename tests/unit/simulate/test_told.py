# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The rough model: what is told scatters about the truth as it is told, and holds nothing that only truth knows."""

from dataclasses import replace

import numpy as np
import pytest

from fairlead.simulate import ModelError, simulate
from fairlead.simulate.streams import Streams
from fairlead.simulate.told import draw_targets
from fairlead.types import KnownDistance, MotionPrior


def mean_square(scenario, draws):
    """Mean of e^T P0^-1 e and of e e^T over flights; e: told minus true landmarks."""
    squares, errors = [], []
    for seed in range(draws):
        true, told = draw_targets(scenario, Streams(seed))
        e = (told.positions - true.positions).ravel()
        errors.append(e)
        squares.append(e @ np.linalg.solve(told.covariance, e))
    return np.mean(squares), np.array(errors)


@pytest.fixture(scope="module")
def short(plain):
    return replace(plain, frames=replace(plain.frames, rate_hz=None, count=1))


@pytest.mark.parametrize(
    "model",
    [
        ModelError(sigma_m=(2.0, 0.5, 1.0), scale_sigma=0.01),
        ModelError(sigma_m=1.0, correlation_length_m=30.0),
        None,
    ],
)
def test_errors_have_the_told_covariance(short, model):
    """NEES of 300 flights is 3n = 60 within 4 standard errors, sqrt(2 * 60 / 300) each."""
    nees, _ = mean_square(replace(short, model=model), 300)
    assert nees == pytest.approx(60.0, abs=4 * np.sqrt(120 / 300))


def test_neighbours_err_alike(short):
    """Correlation exp(-d / l) of every pair, within 5 standard errors of 400 flights; axes apart."""
    length_m = 25.0
    _, e = mean_square(replace(short, model=ModelError(correlation_length_m=length_m)), 400)
    X = short.target.positions
    expected = np.exp(-np.linalg.norm(X[:, None] - X, axis=2) / length_m)
    parts = e.reshape(400, 20, 3)
    for axis in range(3):
        np.testing.assert_allclose(np.corrcoef(parts[:, :, axis].T), expected, atol=5 / np.sqrt(400))
    assert np.abs(np.corrcoef(parts[:, 3, 0], parts[:, 3, 1])[0, 1]) < 5 / np.sqrt(400)


def test_axes_have_their_own_sigmas(short):
    _, e = mean_square(replace(short, model=ModelError(sigma_m=(3.0, 1.0, 0.3))), 100)
    np.testing.assert_allclose(e.reshape(-1, 3).std(axis=0), [3.0, 1.0, 0.3], rtol=5 / np.sqrt(2 * 2000))


def test_the_told_may_know_less(short):
    """Told independent: the diagonal alone; the draw is the same."""
    model = ModelError(sigma_m=1.0, scale_sigma=0.02, correlation_length_m=30.0)
    knowing, not_knowing = (
        simulate(replace(short, model=replace(model, told_independent=flag)), 7).target_told for flag in (False, True)
    )
    np.testing.assert_array_equal(knowing.positions, not_knowing.positions)
    np.testing.assert_array_equal(not_knowing.covariance, np.eye(60))
    assert np.abs(knowing.covariance - np.eye(60)).max() > 0.1


def test_what_is_told_of_the_error_is_told_at_the_told_landmarks(short):
    """Scale and correlation of (29) are taken at what the estimator knows, never at the truth."""
    model = ModelError(sigma_m=3.0, scale_sigma=0.02, correlation_length_m=30.0)
    told = simulate(replace(short, model=model), 7).target_told
    np.testing.assert_array_equal(told.covariance, model.told_covariance(told.positions))
    assert np.abs(told.covariance - model.told_covariance(short.target.positions)).max() > 0.01


def test_either_may_be_given(short):
    """Truth given: told scatters about the file. Told given: the truth does, by the same error."""
    truth = simulate(short, 3)
    told = simulate(replace(short, target_is="told"), 3)
    given = short.target.positions
    np.testing.assert_array_equal(truth.X_true, given)
    np.testing.assert_array_equal(told.target_told.positions, given)
    np.testing.assert_array_equal(told.X_true, truth.target_told.positions)


def test_the_told_holds_nothing_that_only_truth_knows(short, tmp_path):
    """No surface; the touchdown only as the told landmark; distances as measured; motion as the scenario says."""
    target = short.target
    exact = float(np.linalg.norm(target.positions[0] - target.positions[3]))
    tape = KnownDistance(between=("bow", "gun_muzzle"), length_m=exact, sigma_m=0.1)
    mesh, motion = tmp_path / "mesh.ply", MotionPrior(kind="range", jerk_density_m_s25=0.5)
    rich = replace(short, target=replace(target, mesh=mesh, distances=(tape,)), motion=motion)
    errors = []
    for seed in range(200):
        told = draw_targets(rich, Streams(seed))[1]
        assert told.mesh is None
        assert told.motion == motion
        np.testing.assert_array_equal(told.touchdown, told.positions[told.landmarks.index("helo_spot")])
        errors.append(told.distances[0].length_m - exact)
    assert np.std(errors) == pytest.approx(0.1, rel=4 / np.sqrt(400))
    elsewhere = replace(short, target=replace(target, touchdown=np.array([1.0, 2.0, 3.0])))
    assert simulate(elsewhere, 0).target_told.touchdown is None


def test_an_exact_landmark_stays(short):
    """Sigma 0 in the file's prior: the covariance is singular and the landmark is where it is."""
    covariance = np.eye(60)
    covariance[:3] = covariance[:, :3] = 0.0
    scenario = replace(short, model=None, target=replace(short.target, covariance=covariance))
    flight = simulate(scenario, 1)
    np.testing.assert_allclose(flight.target_told.positions[0], flight.X_true[0], atol=1e-12)
    assert np.abs(flight.target_told.positions[1:] - flight.X_true[1:]).min() > 0.0
