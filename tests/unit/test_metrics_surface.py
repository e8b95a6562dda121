# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""docs/metrics.md eq. (14)-(17), computed by hand."""

import math
from pathlib import Path

import numpy as np
import pytest

from fairlead.evaluate.surface import (
    average_distance,
    diameter,
    load_vertices,
    maximum_distance,
    maximum_projected_distance,
    recall,
    surface_errors,
)
from fairlead.types import Camera

VERTICES = np.array([[1.0, 0, 0], [-1.0, 0, 0], [0, 3.0, 0], [0, 0, 0]])
CAMERA = Camera(
    name="c",
    width=1280,
    height=720,
    model="pinhole",
    K=np.array([[100.0, 0, 640], [0, 100.0, 360], [0, 0, 1]]),
    distortion=np.zeros(0),
)


def pose(x: float = 0.0, depth: float = 10.0, *, half_turn: bool = False) -> np.ndarray:
    T = np.eye(4)
    if half_turn:
        T[:2, :2] = -np.eye(2)
    T[:3, 3] = [x, 0.0, depth]
    return T


def test_a_shift_moves_every_vertex_alike() -> None:
    assert average_distance(pose(0.5), pose(), VERTICES) == pytest.approx(0.5)
    assert maximum_distance(pose(0.5), pose(), VERTICES) == pytest.approx(0.5)
    assert maximum_projected_distance(pose(0.5), pose(), VERTICES, CAMERA) == pytest.approx(5.0)


def test_half_a_turn_about_the_view_eq_14_to_16() -> None:
    # Vertices move by 2, 2, 6 and 0 m.
    assert average_distance(pose(half_turn=True), pose(), VERTICES) == pytest.approx(2.5)
    assert maximum_distance(pose(half_turn=True), pose(), VERTICES) == pytest.approx(6.0)
    assert maximum_projected_distance(pose(half_turn=True), pose(), VERTICES, CAMERA) == pytest.approx(60.0)


def test_a_vertex_behind_the_estimated_camera_is_infinitely_wrong() -> None:
    assert maximum_projected_distance(pose(depth=-10.0), pose(), VERTICES, CAMERA) == math.inf


def test_diameter() -> None:
    assert diameter(VERTICES) == pytest.approx(math.sqrt(10.0))
    corners = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 2.0) for z in (0.0, 2.0)])
    inside = np.random.default_rng(0).uniform(0.1, 0.9, size=(50, 3))
    assert diameter(np.vstack([inside, corners])) == pytest.approx(3.0)
    flat = np.vstack([corners[corners[:, 2] == 0.0], [[0.5, 0.5, 0.0]]])
    assert diameter(flat) == pytest.approx(math.sqrt(5.0))


def test_recall_eq_17_counts_silence_as_missed() -> None:
    assert recall(np.array([0.5, 1.5, np.nan, np.inf]), (1.0, 2.0)) == pytest.approx((1 + 2) / 8)
    assert recall(np.array([1.0]), (1.0,)) == 0.0  # strictly below
    assert math.isnan(recall(np.zeros(0), (1.0,)))


def test_limits_follow_the_diameter_and_the_width() -> None:
    T_true = np.repeat(pose()[None], 3, axis=0)
    T = np.stack([pose(0.3), pose(1.0), np.full((4, 4), np.nan)])
    found = surface_errors(T, T_true, VERTICES, CAMERA)
    d = math.sqrt(10.0)
    assert found.add_m == pytest.approx(np.array([0.3, 1.0, np.nan]), nan_ok=True)
    assert found.add_recall == pytest.approx(1 / 3)  # 0.3 < 0.316 <= 1.0
    # 0.3 / d = 0.095 is below 9 limits of ten (0.10 .. 0.50), 1 / d = 0.316 below 4 (0.35 .. 0.50).
    assert (0.3 / d, 1.0 / d) == (pytest.approx(0.0949, abs=1e-4), pytest.approx(0.3162, abs=1e-4))
    assert found.mssd_recall == pytest.approx((9 + 4) / 30)
    # 3 px and 10 px against 10, 20, .. 100 px (width 1280): 3 is below 10 of ten, 10 below 9.
    assert found.mspd_recall == pytest.approx((10 + 9) / 30)
    assert found.mssd_summary.count == 2
    without_camera = surface_errors(T, T_true, VERTICES, None)
    assert without_camera.mspd_px is None
    assert without_camera.mspd_recall is None


def test_mesh_file(tmp_path: Path) -> None:
    path = tmp_path / "mesh.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n")
    assert load_vertices(path).tolist() == [[0, 0, 0], [1, 0, 0], [0, 2, 0]]


@pytest.mark.parametrize("content", [b"", b"ply\nformat ascii 1.0\nelement vertex 9\nend_header\n", b"\x00\xff" * 40])
def test_a_broken_mesh_is_one_clear_line(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "mesh.ply"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=r"mesh\.ply: ") as caught:
        load_vertices(path)
    assert "\n" not in str(caught.value)
