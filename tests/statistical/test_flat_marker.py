# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A single square marker seen nearly from above: two poses explain every view, the wrong one must not be believed."""

import numpy as np
import pytest

from fairlead import Camera, Target, Tracker, View, refine
from fairlead.geometry import difference, project, transform

FLIGHTS, VIEWS, SIGMA_PX = 8, 160, 0.5
K = np.array([[800.0, 0.0, 640.0], [0.0, 800.0, 360.0], [0.0, 0.0, 1.0]])
CAMERA = Camera(name="camera", width=1280, height=720, model="pinhole", K=K, distortion=np.zeros(0))
NAMES = ("c0", "c1", "c2", "c3")
SQUARE = 0.25 * np.array([[-1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [-1.0, -1.0, 0.0]])
SURE_AND_WRONG = 40.0
"""Squared distance of a pose from the truth that one of two million true ones has [-]."""


def flight(seed: int, corner_sigma_m: float) -> tuple[Target, np.ndarray, list[View], np.ndarray]:
    """A marker of 0.5 m, 2 to 40 degrees off the normal, 6 m away and coming nearer while the camera goes round it."""
    rng = np.random.default_rng(seed)
    true = SQUARE + corner_sigma_m * rng.standard_normal(SQUARE.shape)
    azimuth, elevation = rng.uniform(0.0, 2.0 * np.pi), np.radians(rng.uniform(60.0, 88.0))
    views, poses = [], []
    for k in range(VIEWS):
        a, e = azimuth + 0.005 * k, elevation - 0.001 * k
        eye = (6.0 - 0.01 * k) * np.array([np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), np.sin(e)])
        z = -eye / np.linalg.norm(eye)
        x = np.cross(z, [0.0, 0.0, 1.0]) / np.cos(e)
        R = np.vstack([x, np.cross(z, x), z])
        poses.append(np.block([[R, -(R @ eye)[:, None]], [np.zeros((1, 3)), np.ones((1, 1))]]))
        pixels = project(CAMERA, transform(poses[-1], true)) + SIGMA_PX * rng.standard_normal((4, 2))
        S = np.tile(SIGMA_PX**2 * np.eye(2), (4, 1, 1))
        views.append(View(frame=k, stamp_ns=40_000_000 * k, landmarks=NAMES, pixels=pixels, covariances=S))
    told = Target(name="marker", landmarks=NAMES, positions=SQUARE, covariance=corner_sigma_m**2 * np.eye(12))
    return told, true, views, np.array(poses)


@pytest.mark.parametrize("corner_sigma_m", [0.0005, 0.003])
@pytest.mark.parametrize("method", ["track", "refine"])
def test_the_mirror_image_of_a_marker_is_not_believed(method: str, corner_sigma_m: float) -> None:
    """However well its corners are known: hardly any pose is wrong and sure, and the model is not bent to them."""
    squares: list[float] = []
    model_nees: list[float] = []
    for seed in range(FLIGHTS):
        told, true, views, truth = flight(seed, corner_sigma_m)
        if method == "track":
            tracker = Tracker(told, CAMERA)
            estimates, model = [tracker.update(view) for view in views], tracker.model
        else:
            refinement = refine(views, told, CAMERA)
            estimates, model = refinement.estimates, refinement.model
        assert sum(each.ok for each in estimates) > 0.95 * VIEWS
        for each, T in zip(estimates, truth, strict=True):
            if each.ok:
                xi = difference(each.T_camera_target, T)
                squares.append(float(xi @ np.linalg.solve(each.covariance, xi)))
        error = (model.positions - true).ravel()
        model_nees.append(float(error @ np.linalg.solve(model.covariance, error)) / error.size)
    exact = corner_sigma_m < 0.001
    assert np.mean(squares) / 6.0 < (2.0 if exact else 3.5)
    assert np.mean(np.array(squares) > SURE_AND_WRONG) < (0.05 if exact else 0.13)
    assert np.median(model_nees) < (1.8 if exact else 5.0)
    assert np.mean(model_nees) < (3.0 if exact else 7.0)
