# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Errors that the landmarks of a view share: poses are as good as claimed if the estimator is told (docs/motion.md 5).

The network that errs so is measured by `fairlead calibrate`; here errors are drawn with a design effect that is known.
"""

from dataclasses import replace

import numpy as np
import pytest

from fairlead import geometry
from fairlead.evaluate.consistency import pose_normalised_square
from fairlead.tracker import Tracker, TrackerOptions, refine
from fairlead.types import Camera, Target, View

FOCAL_PX, SIGMA_PX, LANDMARKS, VIEWS, SHARED = 1900.0, 1.5, 15, 80, 4.0
"""SHARED: squared error of a pose over that by the landmarks' own errors."""
CAMERA = Camera(
    name="c", width=1024, height=1024, model="pinhole", distortion=np.zeros(0),
    K=np.array([[FOCAL_PX, 0.0, 512.0], [0.0, FOCAL_PX, 512.0], [0.0, 0.0, 1.0]]),
)  # fmt: skip


def jacobian(T: np.ndarray, X: np.ndarray) -> np.ndarray:
    """(2n, 6) by differences."""

    def pixels(xi: np.ndarray) -> np.ndarray:
        return geometry.project(CAMERA, geometry.transform(geometry.perturb(T, xi), X)).ravel()

    return np.stack([(pixels(h) - pixels(-h)) / 2e-5 for h in 1e-5 * np.eye(6)], axis=1)


def flight(seed: int) -> tuple[Target, list[View], np.ndarray, float]:
    """A target that is known to a millimetre, views of it, true poses, and the design effect as calibrate defines it.

    The covariances told are those of all errors of a landmark, shared ones included.
    """
    rng = np.random.default_rng(seed)
    X = rng.uniform(-6.0, 6.0, (LANDMARKS, 3))
    names = tuple(f"p{j}" for j in range(LANDMARKS))
    views, poses = [], []
    grown = 1.0 + 6.0 * (SHARED - 1.0) / (2.0 * LANDMARKS)
    for k in range(VIEWS):
        away = np.array([0.0, 0.0, 60.0, *rng.uniform(-0.05, 0.05, 3)])
        T = geometry.exp_se3(away) @ geometry.exp_se3(np.array([0.0, 0.0, 0.0, 0.3, 0.02 * k, 0.1]))
        J = jacobian(T, X)
        spread = np.linalg.cholesky(np.linalg.inv(J.T @ J)) * SIGMA_PX * np.sqrt(SHARED - 1.0)
        error = SIGMA_PX * rng.standard_normal(2 * LANDMARKS) + J @ spread @ rng.standard_normal(6)
        views.append(
            View(
                frame=k,
                stamp_ns=100_000_000 * k,
                landmarks=names,
                pixels=geometry.project(CAMERA, geometry.transform(T, X)) + error.reshape(-1, 2),
                covariances=np.tile(grown * SIGMA_PX**2 * np.eye(2), (LANDMARKS, 1, 1)),
            )
        )
        poses.append(T)
    known = Target(name="t", landmarks=names, positions=X, covariance=1e-6 * np.eye(3 * LANDMARKS))
    return known, views, np.array(poses), SHARED / grown


@pytest.mark.parametrize("batch", [True, False])
def test_a_pose_is_as_good_as_claimed_if_it_is_told(batch: bool) -> None:
    told, untold, factors, effect = [], [], [], 0.0
    for seed in range(4):
        known, views, poses, effect = flight(seed)
        for found, options in (
            (told, TrackerOptions(design_effect=effect)),
            (untold, TrackerOptions()),
        ):
            if batch:
                answer = refine(views, known, CAMERA, options)
                estimates = answer.estimates
                factors.append(answer.noise_factor)
            else:
                tracker = Tracker(known, CAMERA, options)
                estimates = [tracker.update(view) for view in views]
            late = list(zip(estimates, poses, strict=True))[VIEWS // 4 :]
            found += [pose_normalised_square(e.T_camera_target, T, e.covariance).value / 6.0 for e, T in late]
    assert np.mean(told) == pytest.approx(1.0, abs=0.2)
    assert np.mean(untold) > 1.5
    if batch:  # residuals know only what the landmarks have for themselves
        assert np.mean(factors) == pytest.approx(effect / SHARED, rel=0.08)


def test_one_is_what_it_was() -> None:
    known, views, _, _ = flight(9)
    plain = refine(views, known, CAMERA, TrackerOptions())
    same = refine(views, known, CAMERA, replace(TrackerOptions(), design_effect=1.0))
    assert all(np.array_equal(a.covariance, b.covariance) for a, b in zip(plain.estimates, same.estimates, strict=True))


def test_less_than_one_is_refused() -> None:
    known, _, _, _ = flight(0)
    with pytest.raises(ValueError, match="design_effect"):
        Tracker(known, CAMERA, TrackerOptions(design_effect=0.5))
