# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The clips in data/ show what their truth says."""

from pathlib import Path

import av
import numpy as np
import pytest

from fairlead import geometry
from fairlead.io.camera import load_camera
from fairlead.io.observations import read_views
from fairlead.io.poses import read_truth
from fairlead.io.target import load_target
from fairlead.types import Camera, Matrix4
from fairlead.video.clip import video_stamps
from tests.unit.render.conftest import Shipped

CLIPS = sorted(path.parent for path in (Path(__file__).parents[3] / "data" / "clips").glob("*/clip.mkv"))


def picture_at(path: Path, stamp_ns: int) -> np.ndarray:
    """Decodes from the key frame before a stamp."""
    with av.open(str(path)) as container:
        container.seek(stamp_ns // 1_000, backward=True)
        for frame in container.decode(video=0):
            if round(frame.pts * frame.time_base * 10**9) == stamp_ns:
                return frame.to_ndarray(format="bgr24").astype(float)
    pytest.fail(f"{path}: no picture at {stamp_ns} ns")


def outline_contrast(image: np.ndarray, outside: np.ndarray, inside: np.ndarray, shift_px: int) -> float:
    """Levels between just inside and just outside the outline, moved sideways; median."""
    grey = image.mean(axis=2)
    steps = grey[inside[0], inside[1] + shift_px] - grey[outside[0], outside[1] + shift_px]
    return float(np.median(np.abs(steps)))


def across_the_outline(camera: Camera, T_camera_target: Matrix4, frigate: Shipped) -> tuple[np.ndarray, np.ndarray]:
    """Pixels two outside and two inside the silhouette to its left and right, above the water: rows and columns."""
    depth = frigate.caster.depth(camera, T_camera_target)
    hit = np.isfinite(depth)
    outside, inside = [], []
    for row in np.nonzero(hit.sum(axis=1) > 8)[0]:
        columns = np.nonzero(hit[row])[0]
        for first, step in ((columns[0], -1), (columns[-1], 1)):
            z = depth[row, first]
            ray = np.array([(first - camera.K[0, 2]) / camera.K[0, 0], (row - camera.K[1, 2]) / camera.K[1, 1], 1.0])
            if geometry.transform(geometry.inverse(T_camera_target), (z * ray)[None])[0, 2] > 4.0:
                outside.append((row, first + 2 * step))
                inside.append((row, first - 2 * step))
    return np.array(outside).T, np.array(inside).T


@pytest.mark.parametrize("clip", CLIPS, ids=lambda path: path.name)
def test_stamps_of_the_pictures_are_those_of_the_truth(clip: Path) -> None:
    truth = read_truth(clip / "truth.csv")
    stamps = [pose.stamp_ns for pose in truth]
    assert video_stamps(clip / "clip.mkv") == stamps
    assert [pose.frame for pose in truth] == list(range(len(truth)))
    assert [(view.frame, view.stamp_ns) for view in read_views(clip / "observations_true.csv")] == list(
        enumerate(stamps)
    )
    assert len(truth) >= 150
    assert {step % 40_000_000 for step in np.diff(stamps).tolist()} == {0}
    assert (clip / "clip.mkv").stat().st_size <= 10_000_000


@pytest.mark.parametrize("clip", CLIPS, ids=lambda path: path.name)
def test_the_target_is_where_the_truth_says(clip: Path, frigate: Shipped) -> None:
    """The outline is sharp there and half as sharp, or less, 4 px beside it; landmarks are where they project to."""
    camera, truth = load_camera(clip / "camera.yaml"), read_truth(clip / "truth.csv")
    for pose in (truth[0], truth[-1]):
        image = picture_at(clip / "clip.mkv", pose.stamp_ns)
        assert image.shape == (camera.height, camera.width, 3)
        outside, inside = across_the_outline(camera, pose.T_camera_target, frigate)
        there = outline_contrast(image, outside, inside, 0)
        beside = [outline_contrast(image, outside, inside, shift_px) for shift_px in (-4, 4)]
        assert there > 15.0
        assert max(beside) < 0.5 * there
    exact = load_target(clip / "target_true.toml")
    view = list(read_views(clip / "observations_true.csv"))[-1]
    X = exact.positions[[exact.landmarks.index(name) for name in view.landmarks]]
    assert np.abs(geometry.project(camera, geometry.transform(truth[-1].T_camera_target, X)) - view.pixels).max() < 1e-6
