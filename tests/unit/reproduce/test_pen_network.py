# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A detector of the pen against its true corners: errors that were put in come out."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fairlead.io.camera import load_camera
from fairlead.io.observations import read_views
from fairlead.io.target import load_target
from fairlead.reproduce.pen_network import PenFound, judge_pen
from fairlead.types import View


@pytest.fixture(scope="module")
def corners(repository: Path) -> list[View]:
    return list(read_views(repository / "data" / "marker_pen" / "observations.csv"))


def judged(repository: Path, views: list[View], corners: list[View]) -> PenFound:
    pen = repository / "data" / "marker_pen"
    return judge_pen(views, corners, load_target(pen / "target.toml"), load_camera(pen / "camera.yaml"))


def noisy(view: View, sigma_px: float, rng: np.random.Generator) -> View:
    """White noise, and a covariance that says so."""
    shape = view.pixels.shape
    S = np.tile(sigma_px**2 * np.eye(2), (shape[0], 1, 1))
    return replace(view, pixels=view.pixels + sigma_px * rng.standard_normal(shape), covariances=S)


def test_a_perfect_detector(repository: Path, corners: list[View]) -> None:
    found = judged(repository, corners, corners)
    assert (found.photographs, found.posed, found.found, found.median_px, found.gross) == (16, 16, 1.0, 0.0, 0.0)
    assert found.corner_px < 0.42  # as tests/real/test_marker_pen.py
    assert found.corner_unseen_px < 0.42
    assert found.rotation_deg < 1e-6
    assert found.position_percent < 1e-6


def test_noise_that_was_put_in_comes_out(repository: Path, corners: list[View]) -> None:
    rng = np.random.default_rng(0)
    found = judged(repository, [noisy(view, 2.0, rng) for view in corners], corners)
    # Rayleigh: median 1.177 sigma, mean 1.253 sigma; 208 of them, so 5 % is one standard deviation.
    assert found.median_px == pytest.approx(2.355, rel=0.2)
    assert found.mean_px == pytest.approx(2.507, rel=0.2)
    assert found.nees == pytest.approx(1.0, abs=0.25)
    assert 0.0 < found.rotation_deg < 2.0
    assert 0.3 < found.corner_px < 2.0


def test_gross_errors_and_what_is_not_found(repository: Path, corners: list[View]) -> None:
    rng = np.random.default_rng(1)
    views: list[View] = []
    for k, view in enumerate(corners):
        z = view.pixels.copy()
        z[0] += 100.0
        moved = replace(noisy(view, 1.0, rng), pixels=z)
        none = replace(view, landmarks=(), pixels=np.empty((0, 2)), covariances=np.empty((0, 2, 2)), scores=None)
        views.append(none if k == 3 else moved)
    found = judged(repository, views, corners)
    total = sum(len(view.landmarks) for view in corners)
    assert found.photographs == 15
    assert found.found == pytest.approx(1.0 - len(corners[3].landmarks) / total)
    assert found.gross == pytest.approx(15.0 / (total - len(corners[3].landmarks)))
    assert found.nees > 100.0
    assert found.corner_px < 2.0  # one of twelve in each photograph is an outlier, and is taken for one
