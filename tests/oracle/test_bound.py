# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The oracle against itself by other roads, and against what can be worked out by hand."""

import numpy as np
import pytest
from scipy.linalg import expm

from fairlead.io.camera import load_camera
from fairlead.io.target import load_target
from fairlead.simulate import ArcScenario, ModelError, ObservationError, Simulation, simulate_arc
from reference.bound import bayesian_bound
from reference.cameras import make_projection, projection_jacobian
from reference.posterior import Problem, robust_loss, robust_weight, solve
from reference.views import move, xi_from_step


@pytest.fixture(scope="module")
def flight(repository) -> Simulation:
    folder = repository / "data" / "frigate"
    scenario = ArcScenario(model=ModelError(sigma_m=1.0, scale_sigma=0.01), observation=ObservationError(sigma_px=1.0))
    return simulate_arc(
        load_target(folder / "target.toml"), load_camera(folder / "camera.yaml"), scenario, np.random.default_rng(7)
    )


@pytest.fixture(scope="module")
def project(flight):
    return make_projection(flight.camera.model, flight.camera.K, flight.camera.distortion)


def observations(flight):
    k, n = len(flight.views), len(flight.X_true)
    view, landmark = np.divmod(np.arange(k * n), n)
    return {
        "view": view,
        "landmark": landmark,
        "pixels": np.vstack([v.pixels for v in flight.views]),
        "covariances": np.vstack([v.covariances for v in flight.views]),
    }


def test_step_is_xi(flight):
    """T Exp(xi) = exp(w) R (X - c - dc) to first order: the quotient of steps of 1e-6 leaves 1e-6."""
    T = flight.T_true[:1]
    for i in range(6):
        step = np.zeros((1, 6))
        step[0, i] = 1e-6
        rho, phi = np.split(xi_from_step(T)[0] @ step[0], 2)
        generator = np.zeros((4, 4))
        generator[:3, :3] = np.cross(np.eye(3), phi)
        generator[:3, 3] = rho
        difference = move(T, step)[0] - T[0] @ expm(generator)
        assert np.abs(difference).max() <= 1e-11 * np.abs(T[0]).max()


def test_bound_is_posterior_covariance_without_noise(flight, project):
    """With noise-free observations the optimum is the truth, and Gauss-Newton's inverse Hessian is the bound.

    Assembled by different code: dense numerical Jacobian of everything here, eliminated blocks there. Nine digits of
    the Jacobian, amplified by correlations up to 0.9999 between depth and scale: 1e-4.
    """
    X, T = flight.X_true, flight.T_true
    seen = observations(flight)
    p = np.einsum("kij,nj->kni", T[:, :3, :3], X) + T[:, None, :3, 3]
    seen["pixels"] = project(p).reshape(-1, 2)
    P0 = flight.target_told.covariance
    problem = Problem(project=project, X0=X, P0=P0, **seen)
    solution = solve(problem, X, T)
    bound = bayesian_bound(project, X, P0, T, np.eye(2))
    sigma = np.sqrt(np.diag(bound.landmark_covariance))
    assert np.abs(solution.X - X).max() < 1e-6
    assert np.abs((solution.landmark_covariance - bound.landmark_covariance) / np.outer(sigma, sigma)).max() < 1e-4
    for ours, theirs in zip(solution.pose_covariances, bound.pose_covariances, strict=True):
        sigma = np.sqrt(np.diag(theirs))
        assert np.abs((ours - theirs) / np.outer(sigma, sigma)).max() < 1e-4


def test_bound_of_known_landmarks_is_pose_information(flight, project):
    """P0 = 0: the inverse of each view's own information, here by a numerical Jacobian of one view."""
    X, T = flight.X_true, flight.T_true
    bound = bayesian_bound(project, X, np.zeros((60, 60)), T, 4.0 * np.eye(2))
    J = np.zeros((2 * len(X), 6))
    for i in range(6):
        h = np.zeros((1, 6))
        h[0, i] = 1e-2 if i < 3 else 1e-5
        images = []
        for sign in (1.0, -1.0):
            moved = move(T[:1], sign * h)[0]
            images.append(project(X @ moved[:3, :3].T + moved[:3, 3]).ravel())
        J[:, i] = (images[0] - images[1]) / (2 * h[0, i])
    B = xi_from_step(T[:1])[0]
    expected = B @ np.linalg.inv(J.T @ J / 4.0) @ B.T
    np.testing.assert_allclose(bound.pose_covariances[0], expected, rtol=1e-6, atol=1e-12)
    np.testing.assert_array_equal(bound.landmark_covariance, 0.0)


def test_endless_images_leave_the_gauge(flight, project):
    """docs/bound.md eq. (14): with 1e-3 px only the seven common directions keep the prior's uncertainty."""
    X, T = flight.X_true, flight.T_true
    bound = bayesian_bound(project, X, np.eye(60), T, 1e-6 * np.eye(2))
    d = X - X.mean(axis=0)
    rotation = np.linalg.inv(np.sum(d**2) * np.eye(3) - d.T @ d)
    np.testing.assert_allclose(bound.rotation_variances, np.trace(rotation), rtol=1e-3)
    floor = (np.trace(rotation @ (np.sum(d**2) * np.eye(3) - d.T @ d)) + 3.0 + 1.0) / len(X)
    assert bound.landmark_variance == pytest.approx(floor, rel=1e-3)


def test_more_information_never_hurts(flight, project):
    """Half the noise, or half the prior's sigma, gives a covariance that is smaller in every direction."""
    X, T, P0 = flight.X_true, flight.T_true, flight.target_told.covariance
    wide = bayesian_bound(project, X, P0, T, np.eye(2)).landmark_covariance
    for P, S in ((P0, 0.25), (0.25 * P0, 1.0)):
        narrow = bayesian_bound(project, X, P, T, S * np.eye(2)).landmark_covariance
        assert np.linalg.eigvalsh(wide - narrow).min() > -1e-9


def test_unseen_landmark_keeps_its_prior(flight, project):
    """An infinite covariance is no observation; independent priors then stay what they were."""
    S = np.broadcast_to(np.eye(2), (10, 20, 2, 2)).copy()
    S[:, 3] = np.inf
    bound = bayesian_bound(project, flight.X_true, 4.0 * np.eye(60), flight.T_true, S)
    np.testing.assert_allclose(bound.landmark_covariance[9:12, 9:12], 4.0 * np.eye(3), atol=1e-9)


@pytest.mark.parametrize("model", ["pinhole", "plumb_bob", "rational_polynomial", "equidistant"])
def test_projection_jacobian_is_consistent(model):
    """d pi / d p has p in its null space (a point slides along its ray), and depth scales it down."""
    distortion = {"pinhole": 0, "plumb_bob": 5, "rational_polynomial": 8, "equidistant": 4}[model]
    project = make_projection(model, np.array([[900.0, 0, 640], [0, 910, 360], [0, 0, 1]]), np.full(distortion, 0.01))
    p = np.array([[0.4, -0.2, 2.0], [-0.3, 0.5, 3.0]])
    J = projection_jacobian(project, p)
    assert np.abs(np.einsum("nij,nj->ni", J, p)).max() < 1e-6
    np.testing.assert_allclose(projection_jacobian(project, 2 * p), 0.5 * J, rtol=1e-7, atol=1e-6)


def test_loss_is_smooth():
    """docs/bound.md eq. (6): value and slope meet at a, and the value stays below 2 a."""
    a = 9.0
    s = np.linspace(0.1, 400.0, 4001)
    slope = (robust_loss(s + 1e-6, a) - robust_loss(s - 1e-6, a)) / 2e-6
    np.testing.assert_allclose(slope, robust_weight(s, a), atol=1e-6)
    assert robust_loss(s, a).max() < 2 * a
