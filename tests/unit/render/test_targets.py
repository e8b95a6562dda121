# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The shipped meshes are what the generators make, and hold the landmarks of their target.toml."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fairlead.io.errors import InputError
from fairlead.render.frigate import build_frigate
from fairlead.render.satellite import build_satellite
from fairlead.render.surface import Material, Surface
from fairlead.render.surface_file import load_surface, save_surface, to_linear, to_srgb

BUILD = {"frigate": build_frigate, "satellite": build_satellite}


@pytest.mark.parametrize("name", BUILD)
def test_the_shipped_mesh_is_that_of_the_generator(name: str, repository: Path, tmp_path: Path) -> None:
    save_surface(tmp_path / "mesh.ply", BUILD[name]())
    again = load_surface(tmp_path / "mesh.ply")
    kept = load_surface(repository / "data" / name / f"{name}.ply")
    # Single precision of the file, at 140 m.
    assert np.allclose(again.vertices, kept.vertices, atol=2e-5)
    assert np.array_equal(again.faces, kept.faces)
    assert [material.name for material in again.materials] == [material.name for material in kept.materials]


@pytest.mark.parametrize("name", BUILD)
def test_every_landmark_lies_on_the_surface(name: str, shipped: Callable) -> None:
    import trimesh

    ship = shipped(name)
    mesh = trimesh.Trimesh(ship.surface.vertices, ship.surface.faces, process=False)
    _, distances, _ = trimesh.proximity.closest_point_naive(mesh, ship.target.positions)
    # The frigate's table is rounded to 5 mm; 0.1 px of the published camera is 16 mm at its nearest, 300 m.
    assert distances.max() < 5e-3 * ship.surface.diameter / 146.0


@pytest.mark.parametrize("name", BUILD)
def test_every_landmark_is_seen_from_somewhere_and_none_from_everywhere(name: str, shipped: Callable) -> None:
    ship = shipped(name)
    rng = np.random.default_rng(0)
    directions = rng.standard_normal((300, 3))
    directions[:, 2] = np.abs(directions[:, 2]) * (0.4 if name == "frigate" else rng.choice([-1.0, 1.0], 300))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    middle = ship.target.positions.mean(axis=0)
    seen = np.array(
        [ship.caster.visible(middle + 8 * ship.surface.diameter * d, ship.target.positions) for d in directions]
    )
    share = dict(zip(ship.target.landmarks, seen.mean(axis=0), strict=True))
    assert min(share.values()) > 0.2, share
    assert seen.all(axis=1).mean() < 0.2


def test_the_frigate_fills_its_box(repository: Path) -> None:
    low, high = build_frigate().corners
    assert np.allclose(high, [140.0, 9.0, 32.0], atol=0.02)
    assert low[0] == pytest.approx(0.0, abs=0.1)
    assert low[1] == pytest.approx(-9.0, abs=0.02)
    assert low[2] < -5.0


def test_surfaces_survive_a_file(tmp_path: Path) -> None:
    red, mirror = (
        Material(name="red", colour=(0.5, 0.02, 0.01)),
        Material(name="mirror", colour=(0.9, 0.9, 0.9), roughness=0.0),
    )
    surface = Surface(
        vertices=np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]]),
        faces=np.array([[0, 1, 2], [0, 2, 3]]),
        materials=(red, mirror),
        material_of_face=np.array([0, 1]),
    )
    save_surface(tmp_path / "two.ply", surface)
    again = load_surface(tmp_path / "two.ply")
    assert np.array_equal(again.vertices, surface.vertices)
    assert [again.materials[k].name for k in again.material_of_face] == ["red", "mirror"]
    assert again.roughness.tolist() == [0.55, 0.0]
    # Half of one 8-bit step of sRGB is at most 0.4 % of the linear range.
    assert np.abs(again.colours - surface.colours).max() < 4.5e-3


def test_a_mesh_of_another_program_is_read_too(tmp_path: Path) -> None:
    (tmp_path / "plain.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n")
    surface = load_surface(tmp_path / "plain.obj")
    assert len(surface.faces) == 2
    assert surface.diameter == pytest.approx(np.sqrt(3.0))


@pytest.mark.parametrize("text", ["", "ply\nformat ascii 1.0\nend_header\n", "no mesh at all"])
def test_a_file_that_is_no_mesh_is_one_line(text: str, tmp_path: Path) -> None:
    (tmp_path / "broken.ply").write_text(text)
    with pytest.raises(InputError, match=r"broken\.ply: ") as raised:
        load_surface(tmp_path / "broken.ply")
    assert "\n" not in str(raised.value)


def test_srgb_there_and_back() -> None:
    values = np.linspace(0.0, 1.0, 50)
    assert np.allclose(to_linear(to_srgb(values)), values, atol=1e-12)
    assert to_srgb(np.array(0.0031308)) == pytest.approx(0.04045, abs=1e-5)
