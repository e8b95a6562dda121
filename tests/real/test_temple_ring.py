# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A plaster temple photographed by a gantry (Seitz et al. 2006); the told model is 3 % of its size off."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from fairlead.geometry import align_similarity
from fairlead.io.camera import load_camera
from fairlead.io.observations import read_views
from fairlead.io.poses import read_truth
from fairlead.io.target import load_target
from fairlead.tracker import Tracker, refine
from fairlead.types import Camera, Estimate, Target, TruthPose, View


class Ring:
    """The data set, and what an answer is worth on it."""

    def __init__(self, folder: Path) -> None:
        self.target: Target = load_target(folder / "target.toml")
        self.true: Target = load_target(folder / "target_true.toml")
        self.camera: Camera = load_camera(folder / "camera.yaml")
        self.views: list[View] = list(read_views(folder / "observations.csv"))
        self.truth: list[TruthPose] = list(read_truth(folder / "truth.csv"))

    def landmarks_mm(self, model: Target) -> float:
        """Rms distance of the landmarks after the best similarity [mm]."""
        moved = align_similarity(self.true.positions, model.positions).apply(model.positions)
        return 1e3 * float(np.sqrt(np.mean(np.sum((moved - self.true.positions) ** 2, axis=1))))

    def camera_percent(self, estimates: Sequence[Estimate], model: Target) -> float:
        """Rms error of the camera's position [% of range] after the similarity that aligns the model."""
        alignment = align_similarity(self.true.positions, model.positions)
        pairs = {truth.stamp_ns: truth.T_camera_target for truth in self.truth}
        errors = []
        for estimate in estimates:
            T, T_true = estimate.T_camera_target, pairs[estimate.stamp_ns]
            centre, centre_true = -T[:3, :3].T @ T[:3, 3], -T_true[:3, :3].T @ T_true[:3, 3]
            error = alignment.apply(centre[None])[0] - centre_true
            errors.append(np.linalg.norm(error) / np.linalg.norm(T_true[:3, 3]))
        return 100.0 * float(np.sqrt(np.mean(np.square(errors))))


@pytest.fixture
def ring(shared_data: Path) -> Ring:
    folder = shared_data / "temple_ring"
    if not folder.is_dir():
        pytest.skip("temple_ring is not here")
    return Ring(folder)


def test_batch_recovers_model_and_cameras(ring: Ring) -> None:
    found = refine(ring.views, ring.target, ring.camera)
    assert all(estimate.ok for estimate in found.estimates)
    assert ring.landmarks_mm(ring.target) > 4.0
    assert ring.landmarks_mm(found.model) <= 0.10
    assert ring.camera_percent(found.estimates, found.model) <= 0.7


def test_tracker_recovers_model_and_cameras(ring: Ring) -> None:
    tracker = Tracker(ring.target, ring.camera)
    estimates = [tracker.update(view) for view in ring.views]
    assert all(estimate.ok for estimate in estimates)
    assert ring.landmarks_mm(tracker.model) <= 0.10
    half = len(estimates) // 2
    assert ring.camera_percent(estimates[half:], tracker.model) <= 1.5
