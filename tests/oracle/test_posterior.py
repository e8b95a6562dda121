# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The core against the slow oracle: same optimum, same covariance of model and poses."""

import numpy as np
import pytest
from scipy.linalg import eigvalsh

import fairlead as fl
from fairlead import _core, geometry
from fairlead.simulate import ArcScenario, ModelError, ObservationError, simulate_arc
from fairlead.tracker import core_camera
from reference.cameras import make_projection
from reference.posterior import Problem, Solution, solve

OPTIMUM_SIGMA = 2e-3
"""A window solve stops when a step promises less than 1e-9 of a cost of 100 to 200: steps of sqrt(2 * 2e-7) sigma."""
SETTLED = 0.02
"""`refine` is content when its noise and prior factors change by less than 0.01: so much may covariances differ, and
the optimum by that share of the few sigma between model and prior."""

CAMERAS = {
    "pinhole": (),
    "plumb_bob": (-0.2, 0.05, 1e-3, -5e-4, 0.01),
    "rational_polynomial": (0.1, -0.05, 1e-3, 5e-4, 0.01, 0.3, -0.02, 0.01),
    "equidistant": (-0.03, 0.02, -0.01, 0.002),
}

SCENARIOS = {
    "one metre, one pixel": ArcScenario(views=4),
    "shared scale": ArcScenario(angle_deg=60.0, views=5, model=ModelError(sigma_m=0.5, scale_sigma=0.02)),
    "narrow": ArcScenario(angle_deg=10.0, views=5, observation=ObservationError(sigma_px=0.5)),
    "outliers": ArcScenario(views=4, observation=ObservationError(sigma_px=1.0, outlier_fraction=0.1)),
}


def camera_of(model: str) -> fl.Camera:
    K = np.array([[1910.0, 0.0, 511.5], [0.0, 1910.0, 511.5], [0.0, 0.0, 1.0]])
    return fl.Camera(name=model, width=1024, height=1024, model=model, K=K, distortion=np.array(CAMERAS[model]))


def by_oracle(flight, noise_factor: float, prior_factor: float, X: np.ndarray, T: np.ndarray) -> Solution:
    """The oracle on the same observations and factors, from the start (X, T)."""
    n = len(flight.target_told.landmarks)
    view, landmark = np.divmod(np.arange(n * len(flight.views)), n)
    problem = Problem(
        project=make_projection(flight.camera.model, flight.camera.K, flight.camera.distortion),
        X0=flight.target_told.positions,
        P0=flight.target_told.covariance,
        view=view,
        landmark=landmark,
        pixels=np.vstack([v.pixels for v in flight.views]),
        covariances=np.vstack([v.covariances for v in flight.views]),
        loss_threshold=fl.TrackerOptions().loss_threshold,
        noise_factor=noise_factor,
        prior_factor=prior_factor,
    )
    return solve(problem, X, T)


def in_sigma(difference: np.ndarray, covariance: np.ndarray) -> float:
    return float(np.max(np.abs(difference) / np.sqrt(np.diag(covariance))))


def share(a: np.ndarray, b: np.ndarray) -> float:
    """Largest difference of two covariances in units of the standard deviations of b."""
    sigma = np.sqrt(np.diag(b))
    return float(np.max(np.abs(a - b) / np.outer(sigma, sigma)))


def fly(repository, model: str, name: str):
    target = fl.load_target(repository / "data" / "frigate" / "target.toml")
    return simulate_arc(target, camera_of(model), SCENARIOS[name], np.random.default_rng(11))


@pytest.mark.parametrize("model", list(CAMERAS))
@pytest.mark.parametrize("name", ["one metre, one pixel", "outliers"])
def test_window_solve_finds_the_oracles_optimum(repository, model, name):
    """Same cost and same optimum from the truth, with all factors 1."""
    flight = fly(repository, model, name)
    k, n = len(flight.views), len(flight.X_true)
    view, landmark = np.divmod(np.arange(n * k, dtype=np.int32), n)
    X0, P0 = flight.target_told.positions, flight.target_told.covariance
    pixels, covariances = (np.concatenate([getattr(v, key) for v in flight.views]) for key in ("pixels", "covariances"))
    X, T, cost, *_ = _core.solve_window(
        core_camera(flight.camera), flight.X_true, flight.T_true, view, landmark, pixels, covariances,
        prior_mean=X0, prior_information=np.linalg.inv(P0), loss_threshold=fl.TrackerOptions().loss_threshold,
    )  # fmt: skip
    expected = by_oracle(flight, 1.0, 1.0, flight.X_true, flight.T_true)
    assert expected.gradient_norm < 1e-4
    assert cost == pytest.approx(expected.cost, rel=1e-6)
    assert in_sigma((X - expected.X).ravel(), expected.landmark_covariance) < OPTIMUM_SIGMA
    for T_core, T_oracle, P in zip(T, expected.T_camera_target, expected.pose_covariances, strict=True):
        assert in_sigma(geometry.difference(T_oracle, T_core), P) < OPTIMUM_SIGMA


@pytest.mark.parametrize("name", list(SCENARIOS))
def test_refine_finds_the_oracles_optimum_and_covariance(repository, name):
    """From the told model and no poses, at the factors that it reports; the oracle starts at the truth."""
    flight = fly(repository, "pinhole", name)
    found = fl.refine(flight.views, flight.target_told, flight.camera)
    assert found.converged
    likely, believed = found.prior_factor, found.prior_factor_believed
    expected = by_oracle(flight, found.noise_factor, believed, flight.X_true, flight.T_true)
    S = expected.landmark_covariance
    assert in_sigma((found.model.positions - expected.X).ravel(), S) < SETTLED
    joseph = S + (likely - believed) / believed**2 * S @ np.linalg.solve(flight.target_told.covariance, S)
    ratios = eigvalsh(found.model.covariance, joseph)  # the curvature of the gauge comes on top
    assert 1.0 - SETTLED < ratios.min() < 1.0 + SETTLED
    assert np.median(ratios) < 1.1
    for estimate, T, P in zip(found.estimates, expected.T_camera_target, expected.pose_covariances, strict=True):
        assert in_sigma(geometry.difference(T, estimate.T_camera_target), P) < SETTLED
        assert eigvalsh(estimate.covariance, P).min() > 1.0 - SETTLED
