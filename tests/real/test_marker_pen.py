# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A pen with eight tags whose drawing is wrong (github.com/Jcparkyn/dpoint): corner tables of two detectors."""

from pathlib import Path

import numpy as np
import pytest

from fairlead.demo import tag_side
from fairlead.geometry import project, transform
from fairlead.io.camera import load_camera
from fairlead.io.observations import read_views
from fairlead.io.target import load_target
from fairlead.tracker import refine
from fairlead.types import View

OURS = Path(__file__).resolve().parents[2] / "data" / "marker_pen"


def rms_px(views: list[View], found: object, camera: object) -> float:
    """Root mean square of |pi(T X_j) - z_j| over all corners, none left out [px]."""
    squares = []
    for view, estimate in zip(views, found.estimates, strict=True):  # type: ignore[attr-defined]
        X = found.model.positions[[found.model.landmarks.index(name) for name in view.landmarks]]  # type: ignore[attr-defined]
        squares.append(np.sum((project(camera, transform(estimate.T_camera_target, X)) - view.pixels) ** 2, axis=1))  # type: ignore[arg-type]
    return float(np.sqrt(np.mean(np.concatenate(squares))))


def test_given_corners(shared_data: Path) -> None:
    folder = shared_data / "marker_pen"
    if not folder.is_dir():
        pytest.skip("marker_pen is not here")
    camera, views = load_camera(folder / "camera.yaml"), list(read_views(folder / "observations.csv"))
    found = refine(views, load_target(folder / "target.toml"), camera)
    assert rms_px(views, found, camera) <= 0.42
    assert 12.60 <= tag_side(found.model).mean_mm <= 12.75


def test_our_corners() -> None:
    camera, views = load_camera(OURS / "camera.yaml"), list(read_views(OURS / "observations.csv"))
    assert sum(len(view.landmarks) for view in views) >= 200
    found = refine(views, load_target(OURS / "target.toml"), camera)
    assert rms_px(views, found, camera) <= 0.42
