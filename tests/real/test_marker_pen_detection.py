# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Our corners of the marker pen: found in the photographs, and good enough to refine the drawing by."""

from pathlib import Path

import numpy as np
import pytest

from fairlead import load_camera, load_target, read_views, refine
from fairlead.baselines.epnp import EpnpTracker
from fairlead.detect import detector_from_spec
from fairlead.geometry import project, transform
from fairlead.sources.image_folder import ImageFolderSource
from fairlead.types import Camera, Matrix4, Target, View


@pytest.fixture(scope="module")
def pen(repository: Path) -> Path:
    return repository / "data" / "marker_pen"


@pytest.fixture(scope="module")
def target(pen: Path) -> Target:
    return load_target(pen / "target.toml")


@pytest.fixture(scope="module")
def camera(pen: Path) -> Camera:
    return load_camera(pen / "camera.yaml")


@pytest.fixture(scope="module")
def table(pen: Path) -> list[View]:
    return list(read_views(pen / "observations.csv"))


def residuals(view: View, T: Matrix4, model: Target, camera: Camera) -> np.ndarray:
    X = model.positions[[model.landmarks.index(name) for name in view.landmarks]]
    return project(camera, transform(T, X)) - view.pixels


def rms(e: np.ndarray) -> float:
    return float(np.sqrt((e**2).sum(axis=1).mean()))


@pytest.mark.slow
def test_the_photographs_give_the_table(marker_pen: Path, target: Target, camera: Camera, table: list[View]) -> None:
    detector = detector_from_spec("aruco:DICT_4X4_100", target)
    images = ImageFolderSource(marker_pen / "images", camera)
    views = [detector.detect(image.image, image.frame, image.stamp_ns) for image in images]
    assert [view.stamp_ns for view in views] == [view.stamp_ns for view in table]
    assert sum(len(view.landmarks) for view in views) >= 200
    for found, kept in zip(views, table, strict=True):
        common = sorted(set(found.landmarks) & set(kept.landmarks))
        assert len(common) >= 0.95 * len(kept.landmarks)
        moved = [found.pixels[found.landmarks.index(name)] - kept.pixels[kept.landmarks.index(name)] for name in common]
        # JPEG decoders and OpenCV's quadrilaterals differ between versions; the corners must not, beyond their noise.
        assert np.abs(moved).max() < 0.2
        assert np.median(np.abs(moved)) < 0.01


def test_one_model_explains_all_corners(table: list[View], target: Target, camera: Camera) -> None:
    assert sum(len(view.landmarks) for view in table) >= 200
    found = refine(table, target, camera)
    e = [residuals(v, x.T_camera_target, found.model, camera) for v, x in zip(table, found.estimates, strict=True)]
    assert rms(np.concatenate(e)) <= 0.42
    # The covariances are true: chi-square over degrees of freedom; 208 corners, 16 poses, 32 landmarks, 7 of the gauge.
    S = np.concatenate([view.covariances for view in table])
    chi_square = np.einsum("ni,nij,nj->", np.concatenate(e), np.linalg.inv(S), np.concatenate(e))
    assert 0.6 < chi_square / (2 * len(S) - 6 * 16 - 3 * 32 + 7) < 1.5


def test_the_refined_model_holds_for_views_that_it_never_saw(table: list[View], target: Target, camera: Camera) -> None:
    model = refine(table[::2], target, camera).model
    errors = {}
    for name, positions in (("drawn", target), ("refined", model)):
        tracker = EpnpTracker(positions, camera)
        estimates = [tracker.update(view) for view in table[1::2]]
        e = [residuals(v, x.T_camera_target, positions, camera) for v, x in zip(table[1::2], estimates, strict=True)]
        errors[name] = rms(np.concatenate(e))
    assert errors["refined"] <= 0.70
    assert errors["refined"] < 0.5 * errors["drawn"]
