# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""With motion kind `target` and 4 px of noise every range came out 80 m short: the path pulled the aspects along."""

import numpy as np
import pytest

from benchmarks.flight import simulated
from fairlead.tracker import Tracker, TrackerOptions

pytestmark = pytest.mark.slow

FRAMES = 200


def range_error_m(seed: int, motion: str) -> float:
    """Of the centroid's distance, mean over the last two of eight seconds."""
    flight = simulated(seed, 4.0, 0.0)
    tracker = Tracker(flight.target_told, flight.camera, TrackerOptions(motion=motion))
    errors = []
    for view, T in zip(flight.views[:FRAMES], flight.T_true[:FRAMES], strict=True):
        found = tracker.update(view).T_camera_target
        X, X_true = tracker.model.positions.mean(axis=0), flight.X_true.mean(axis=0)
        p, p_true = found[:3, :3] @ X + found[:3, 3], T[:3, :3] @ X_true + T[:3, 3]
        errors.append(float(np.linalg.norm(p) - np.linalg.norm(p_true)))
    return float(np.mean(errors[-50:]))


def test_the_path_of_the_target_does_not_shorten_the_range():
    """On the same views kind `range`, which ties no aspect, is the judge: less than 10 m apart (it was 29 to 42 m)."""
    for seed in range(3):
        assert abs(range_error_m(seed, "target") - range_error_m(seed, "range")) < 10.0
