# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Meshes from files, what they hide, and which corners of them are suggested."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from fairlead.annotate.suggest import corner_distinctness, even_directions, suggest_landmarks
from fairlead.annotate.surface import Surface, load_surface
from fairlead.io.errors import InputError
from tests.unit.annotate.conftest import Scene


def box(folder: Path, suffix: str = ".ply") -> Path:
    """2 x 4 x 6 m."""
    path = folder / f"box{suffix}"
    trimesh.creation.box(extents=(2.0, 4.0, 6.0)).export(path)
    return path


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".stl", ".glb"])
def test_a_box_of_any_format_has_eight_vertices_and_twelve_edges(suffix: str, tmp_path: Path) -> None:
    surface = load_surface(box(tmp_path, suffix), scale=0.5)
    assert surface.vertices.shape == (8, 3)
    np.testing.assert_allclose(np.ptp(surface.vertices, axis=0), (1.0, 2.0, 3.0), atol=1e-6)
    assert len(surface.edges.ends) == 12
    np.testing.assert_allclose(surface.edges.turns_rad, 0.5 * np.pi, atol=1e-6)
    assert surface.glb[:4] == b"glTF"


def test_nearest_and_first_hit(tmp_path: Path) -> None:
    surface = load_surface(box(tmp_path))
    np.testing.assert_allclose(surface.nearest(np.array([3.0, 0.5, 1.0])), (1.0, 0.5, 1.0), atol=1e-9)
    hit = surface.first_hit(np.array([9.0, 0.5, 1.0]), np.array([-9.0, 0.5, 1.0]))
    assert hit is not None
    np.testing.assert_allclose(hit, (1.0, 0.5, 1.0), atol=1e-9)
    assert surface.first_hit(np.array([9.0, 0.5, 1.0]), np.array([9.0, 8.0, 1.0])) is None


@pytest.mark.parametrize("fast", [True, False])
def test_a_box_hides_the_corner_behind_it(tmp_path: Path, fast: bool) -> None:
    surface = load_surface(box(tmp_path))
    if not fast:
        vars(surface)["fast"] = None
    elif surface.fast is None:
        pytest.skip("embreex is not installed")
    eye = np.array([20.0, 21.0, 22.0])
    seen = surface.seen_from(eye, surface.vertices)
    expected = ~(surface.vertices < 0.0).all(axis=1)
    np.testing.assert_array_equal(seen, expected)


def test_corners_are_distinct_and_a_sphere_has_none(tmp_path: Path) -> None:
    surface = load_surface(box(tmp_path))
    # Three edges at right angles, each with weight sin 45 deg: M = sin 45 deg I.
    np.testing.assert_allclose(corner_distinctness(surface), np.sqrt(0.5), atol=1e-6)
    trimesh.creation.icosphere(subdivisions=3).export(tmp_path / "ball.stl")
    ball = load_surface(tmp_path / "ball.stl")
    assert len(suggest_landmarks(ball, 8, np.empty((0, 3))).positions) == 0


def test_suggestions_are_corners_far_from_one_another(scene: Scene) -> None:
    found = suggest_landmarks(scene.surface, 12, np.empty((0, 3)))
    assert found.positions.shape == (12, 3)
    gaps = np.linalg.norm(found.positions[:, None] - found.positions, axis=2) + 1e9 * np.eye(12)
    assert gaps.min() > 0.1 * scene.surface.size_m
    on_it = [np.linalg.norm(scene.surface.nearest(X) - X) for X in found.positions]
    assert max(on_it) < 1e-9
    assert found.visible.min() > 0.3
    # The ends of both wings are in it: nothing is farther out.
    assert found.positions[:, 1].min() < -6.0
    assert found.positions[:, 1].max() > 6.0


def test_suggestions_keep_away_from_landmarks_that_are_there(scene: Scene) -> None:
    first = suggest_landmarks(scene.surface, 6, np.empty((0, 3))).positions
    second = suggest_landmarks(scene.surface, 6, first).positions
    gaps = np.linalg.norm(first[:, None] - second, axis=2)
    assert gaps.min() > 0.05 * scene.surface.size_m


def test_directions_are_even() -> None:
    d = even_directions(48)
    np.testing.assert_allclose(np.linalg.norm(d, axis=1), 1.0)
    np.testing.assert_allclose(d.mean(axis=0), 0.0, atol=0.02)
    np.testing.assert_allclose(d.T @ d / 48, np.eye(3) / 3.0, atol=0.02)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.ply", b"ply\nnonsense", "no readable mesh"),
        ("a.stl", b"", "no readable mesh|finite triangles"),
        ("a.obj", b"v 0 0 0\n", "no readable mesh|finite triangles"),
        ("a.txt", b"", "expected a mesh"),
        ("a.glb", b"glTF\x02\x00\x00\x00", "no readable mesh"),
    ],
)
def test_a_bad_mesh_is_one_line(name: str, content: bytes, message: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=message) as error:
        load_surface(tmp_path / name)
    assert "\n" not in str(error.value)


def test_a_mesh_that_is_not_there_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read: No such file"):
        load_surface(tmp_path / "none.ply")


def test_a_surface_knows_its_size(tmp_path: Path) -> None:
    surface: Surface = load_surface(box(tmp_path))
    assert surface.size_m == pytest.approx(np.sqrt(4.0 + 16.0 + 36.0))
    np.testing.assert_allclose(surface.middle, 0.0, atol=1e-9)
