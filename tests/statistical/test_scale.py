# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Images do not show the size of a model: what is told of it is what comes out, and is told of the result."""

import numpy as np
import pytest

from fairlead import Camera, Target, Tracker, View, refine
from fairlead.geometry import project, transform

FLIGHTS, VIEWS = 12, 14
SIGMA_M, SCALE_SIGMA = 0.3, 0.05
K = np.array([[1200.0, 0.0, 640.0], [0.0, 1200.0, 480.0], [0.0, 0.0, 1.0]])
CAMERA = Camera(name="camera", width=1280, height=960, model="pinhole", K=K, distortion=np.zeros(0))


def flight(n: int, seed: int, sigma_m: float = SIGMA_M) -> tuple[Target, np.ndarray, list[View]]:
    """A told model, the true landmarks drawn from what is told, and views on an arc of 100 degrees at 300 m."""
    rng = np.random.default_rng(seed)
    told = rng.uniform([-40.0, -10.0, -8.0], [40.0, 10.0, 8.0], (n, 3))
    names = tuple(f"p{j}" for j in range(n))
    about = (told - told.mean(axis=0)).ravel()
    P0 = sigma_m**2 * np.eye(3 * n) + SCALE_SIGMA**2 * np.outer(about, about)
    scale = 1.0 + SCALE_SIGMA * rng.standard_normal()
    true = told + (scale - 1.0) * about.reshape(-1, 3) + scale * sigma_m * rng.standard_normal((n, 3))
    views = []
    for k, angle in enumerate(np.radians(np.linspace(-50.0, 50.0, VIEWS))):
        eye = 300.0 * np.array([np.cos(angle), np.sin(angle), 0.4])
        z = -eye / np.linalg.norm(eye)
        x = np.cross(z, [0.0, 0.0, 1.0])
        x /= np.linalg.norm(x)
        R = np.vstack([x, np.cross(z, x), z])
        T = np.block([[R, -(R @ eye)[:, None]], [np.zeros((1, 3)), np.ones((1, 1))]])
        pixels = project(CAMERA, transform(T, true)) + rng.standard_normal((n, 2))
        views.append(
            View(frame=k, stamp_ns=10**9 * k, landmarks=names, pixels=pixels, covariances=np.tile(np.eye(2), (n, 1, 1)))
        )
    return Target(name="box", landmarks=names, positions=told, covariance=P0), true, views


def size(X: np.ndarray) -> float:
    return float(np.linalg.norm(X - X.mean(axis=0)))


@pytest.mark.parametrize("n", [12, 60])
def test_a_model_of_unknown_size_keeps_the_size_that_was_told(n: int) -> None:
    """Neither smaller nor larger on average, as far off as was told, and it says so: batch and online."""
    errors: dict[str, list[float]] = {"batch": [], "online": []}
    told_sigmas = []
    for seed in range(FLIGHTS):
        target, true, views = flight(n, seed)
        found = refine(views, target, CAMERA).model
        tracker = Tracker(target, CAMERA)
        for view in views:
            tracker.update(view)
        for name, X in (("batch", found.positions), ("online", tracker.model.positions)):
            errors[name].append(size(X) / size(true) - 1.0)
        about = (found.positions - found.positions.mean(axis=0)).ravel()
        told_sigmas.append(float(np.sqrt(about @ found.covariance @ about)) / size(found.positions) ** 2)
    for values in errors.values():
        assert abs(np.mean(values)) < 3.0 * SCALE_SIGMA / np.sqrt(FLIGHTS)
        assert 0.5 * SCALE_SIGMA < np.sqrt(np.mean(np.square(values))) < 1.6 * SCALE_SIGMA
    assert told_sigmas == pytest.approx([SCALE_SIGMA] * FLIGHTS, rel=0.15)


def test_exact_shape_of_unknown_size_is_a_prior_like_any_other() -> None:
    """No error but that of scale: a covariance of rank one. What comes out can be told again."""
    target, true, views = flight(20, 3, sigma_m=0.0)
    found = refine(views, target, CAMERA)
    tracker = Tracker(target, CAMERA)
    estimates = [tracker.update(view) for view in views]
    assert all(each.ok for each in (*estimates, *found.estimates))
    for model in (found.model, tracker.model):
        assert size(model.positions) / size(target.positions) == pytest.approx(1.0, abs=0.01)
        assert np.array_equal(model.covariance, model.covariance.T)
    again = refine(views, found.model, CAMERA)
    assert size(again.model.positions) == pytest.approx(size(found.model.positions), rel=0.01)
    assert np.linalg.norm(true - true.mean(axis=0)) > 0.0
