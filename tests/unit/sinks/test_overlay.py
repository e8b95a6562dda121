# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The overlay shows the target where it is, and how sure that is."""

from pathlib import Path

import numpy as np
import pytest

from fairlead import Tracker, load_target
from fairlead.cameras import project
from fairlead.geometry import exp_se3, perturb, point_covariance, transform
from fairlead.io.errors import InputError
from fairlead.io.mesh import load_mesh
from fairlead.sinks.overlay import OverlayPainter
from fairlead.sinks.overlay.caption import describe
from fairlead.sinks.overlay.inset import Follower
from fairlead.sinks.overlay.picture import MODEL, TRUE
from fairlead.sinks.overlay.projection import landmark_ellipses, silhouette
from fairlead.sinks.sink import Outcome
from tests.clip import CAMERA, Clip, true_pose
from tests.outcomes import estimate, lost, no_view


def mask_of(edges: list[np.ndarray]) -> np.ndarray:
    from fairlead import opencv

    mask = np.zeros((CAMERA.height, CAMERA.width), np.uint8)
    opencv.fill_region(mask, edges)
    return mask > 127


def test_the_silhouette_covers_the_drawn_tags_and_nothing_else(clip: Clip) -> None:
    mesh = load_mesh(clip.folder / "book.ply")
    found = mask_of(silhouette(CAMERA, mesh, true_pose(7), 4.0))
    corners = project(CAMERA, transform(true_pose(7), mesh.vertices)).reshape(4, 4, 2)
    y, x = np.mgrid[: CAMERA.height, : CAMERA.width]
    inside = np.zeros_like(found)
    for quad in corners:  # on the right of every edge
        sides = [
            (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])
            for a, b in zip(quad, np.roll(quad, -1, axis=0), strict=True)
        ]
        inside |= np.all(np.array(sides) > 0.0, axis=0)
    # One pixel of rim may fall either way.
    rim = sum(float(np.linalg.norm(quad - np.roll(quad, 1, axis=0), axis=1).sum()) for quad in corners)
    assert rim < 0.15 * inside.sum()
    assert np.logical_xor(found, inside).sum() < rim


def test_a_target_behind_the_camera_has_no_silhouette(clip: Clip) -> None:
    mesh = load_mesh(clip.folder / "book.ply")
    assert silhouette(CAMERA, mesh, exp_se3(np.array([0.0, 0.0, -1.0, 0.0, 0.0, 0.0])), 1.0) == []
    assert silhouette(CAMERA, mesh, exp_se3(np.array([9.0, 0.0, 1.0, 0.0, 0.0, 0.0])), 1.0) == []


def test_ellipses_are_those_of_drawn_poses() -> None:
    rng = np.random.default_rng(5)
    A = rng.normal(size=(6, 6)) * 1e-3
    S = A @ A.T
    T, X = true_pose(3), np.array([[0.1, -0.05, 0.02], [0.0, 0.0, 0.0]])
    pixels, covariances = landmark_ellipses(CAMERA, estimate(T, S), X)
    drawn = rng.multivariate_normal(np.zeros(6), S, size=4000)
    for j in range(2):
        points = np.array([transform(perturb(T, xi), X[j : j + 1])[0] for xi in drawn])
        sampled = np.cov(project(CAMERA, points).T)
        # 4000 draws know a variance to 1 / sqrt(2000) = 2.2 %; four sigma.
        np.testing.assert_allclose(covariances[j], sampled, atol=0.09 * np.abs(sampled).max())
        np.testing.assert_allclose(
            point_covariance(T, S, X[j]), np.cov(points.T), atol=0.09 * np.abs(np.cov(points.T)).max()
        )
    np.testing.assert_allclose(pixels, project(CAMERA, transform(T, X)))


def test_pictures_have_the_size_of_the_image_and_leave_it_alone(clip: Clip) -> None:
    target = load_target(clip.folder / "target.toml")
    tracker = Tracker(target, CAMERA)
    painter = OverlayPainter(target, CAMERA, tracker, mesh=load_mesh(clip.folder / "book.ply"))
    image = clip.images[0]
    before = image.copy()
    picture = painter.paint(Outcome(estimate=estimate(true_pose(0)), view=no_view(), image=image))
    assert picture.shape == image.shape
    assert (image == before).all()
    lost_picture = painter.paint(Outcome(estimate=lost(), view=no_view(), image=image))
    assert (lost_picture[120:] == image[120:]).all(), "nothing is drawn over the image but the caption"
    assert (painter.paint(Outcome(estimate=lost(), view=no_view())).shape) == image.shape


def test_the_outline_is_where_the_pose_is_and_truth_is_yellow(clip: Clip) -> None:
    target = load_target(clip.folder / "target.toml")
    mesh = load_mesh(clip.folder / "book.ply")
    off = exp_se3(np.array([0.15, 0.0, 0.75, 0.0, 0.0, 0.0]))
    painter = OverlayPainter(target, CAMERA, Tracker(target, CAMERA), mesh=mesh, truth={0: true_pose(0)})
    grey = np.full((CAMERA.height, CAMERA.width, 3), 100, np.uint8)
    picture = painter.paint(Outcome(estimate=estimate(off), view=no_view(), image=grey)).astype(int)
    x = np.nonzero(np.abs(picture - MODEL).sum(axis=2) < 60)[1]
    expected = project(CAMERA, transform(off, mesh.vertices))
    assert expected[:, 0].min() - 3 < x.min() <= x.max() < expected[:, 0].max() + 3
    x = np.nonzero(np.abs(picture - TRUE).sum(axis=2) < 60)[1]
    true = project(CAMERA, transform(true_pose(0), mesh.vertices))
    assert x.min() < true[:, 0].min() + 3


def test_the_caption_says_range_and_how_sure(clip: Clip) -> None:
    target = load_target(clip.folder / "target.toml")
    S = np.diag([4e-6, 4e-6, 4e-6, 0.0, 0.0, np.radians(2.0) ** 2])
    lines = describe(estimate(exp_se3(np.array([0.0, 0.0, 1.25, 0.0, 0.0, 0.0])), S), target)
    assert lines[1:4] == ["range 1.250 ± 0.002 m", "lateral ± 0.0020 m", "attitude ± 2.00°"]
    assert describe(lost(), target)[1] == "too few"


def test_the_inset_stays_off_the_target_and_goes_when_it_is_large() -> None:
    follower = Follower(1000, 800)
    for x in np.linspace(50, 950, 60):
        window = follower.follow(np.array([x - 30, 100.0]), np.array([x + 30, 140.0]))
        assert window is not None
        over = min(x + 30, window.left + window.side) - max(x - 30, window.left)
        down = min(140.0, window.top + window.side) - max(100.0, window.top)
        assert min(over, down) <= 0.0
        assert window.left + window.side > 500 or window.top > 300, "the caption's corner"
        assert 0 <= window.left <= 1000 - window.side
        assert 0 <= window.top <= 800 - window.side
    for _ in range(40):
        window = follower.follow(np.array([300.0, 200.0]), np.array([700.0, 600.0]))
    assert window is None


def test_a_broken_mesh_is_one_line(tmp_path: Path) -> None:
    path = tmp_path / "mesh.ply"
    path.write_bytes(b"ply\nnothing")
    with pytest.raises(InputError, match=r"mesh\.ply"):
        load_mesh(path)
