# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Meshes of tag bundles: the printed pattern is where the landmarks are, judged by rays and by OpenCV's detector."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fairlead import geometry
from fairlead.cli import main
from fairlead.detect.fiducial import TagDetector
from fairlead.opencv import marker_image
from fairlead.render.errors import RenderError
from fairlead.render.raycast import RayCaster
from fairlead.render.tagged import CORNERS, tagged_surface
from fairlead.render.viewpoints import direction, look_at
from fairlead.types import Target
from tests.unit.render.conftest import Shipped, pinhole

FAMILY = "DICT_4X4_100"
WALL = np.array([[-0.5, 0.5, 0.0], [0.5, 0.5, 0.0], [0.5, -0.5, 0.0], [-0.5, -0.5, 0.0]])
"""A tag of 1 m that looks along z, upright with y."""


def bundle(quads: dict[int, np.ndarray]) -> Target:
    """Landmarks at the corners of these tags."""
    names = tuple(f"tag{tag}_{corner}" for tag in quads for corner in CORNERS)
    X = np.concatenate(list(quads.values()))
    return Target(name="bundle", landmarks=names, positions=X, covariance=np.zeros((3 * len(X), 3 * len(X))))


def materials(target: Target, points: np.ndarray, towards: np.ndarray, quiet: float = 1.0) -> list[str]:
    """What rays from 10 m before the points meet."""
    surface = tagged_surface(target, FAMILY, quiet=quiet)
    hits = RayCaster(surface).cast(points - 10.0 * towards, np.tile(towards, (len(points), 1)))
    return [surface.materials[surface.material_of_face[face]].name if face >= 0 else "" for face in hits.faces]


def test_a_tag_has_its_cells_in_their_places() -> None:
    pytest.importorskip("embreex")
    target, n = bundle({7: WALL}), 6
    white = marker_image(FAMILY, 7, 1) > 127
    u, v = np.meshgrid((np.arange(n) + 0.5) / n - 0.5, 0.5 - (np.arange(n) + 0.5) / n)
    points = np.column_stack([u.ravel(), v.ravel(), np.zeros(n * n)])
    seen = materials(target, points, np.array([0.0, 0.0, -1.0]))
    assert seen == ["paper" if each else "ink" for each in white.ravel()]
    assert 0 < sum(white.ravel()) < n * n


def test_corners_part_ink_from_paper_and_behind_is_the_body() -> None:
    pytest.importorskip("embreex")
    target = bundle({7: WALL})
    inside, outside = materials(target, np.array([0.99 * WALL[0], 1.01 * WALL[0]]), np.array([0.0, 0.0, -1.0]))
    assert (inside, outside) == ("ink", "paper")
    wide = [materials(target, np.array([1.45 * WALL[0]]), np.array([0.0, 0.0, -1.0]), quiet)[0] for quiet in (1.0, 3.0)]
    assert wide == ["", "paper"]
    assert materials(target, 0.9 * WALL, np.array([0.0, 0.0, 1.0])) == ["body"] * 4


def test_a_tag_in_a_corner_is_not_buried() -> None:
    """Two walls that face each other at a right angle: the convex hull of both would hide them."""
    pytest.importorskip("embreex")
    left = WALL @ geometry.exp_so3(np.array([0.0, 0.5 * np.pi, 0.0])).T + [-0.8, 0.0, 0.8]
    target = bundle({7: WALL, 8: left})
    seen = materials(target, np.array([[0.0, 0.42, 0.0]]), np.array([0.0, 0.0, -1.0]))
    seen += materials(target, np.array([[-0.8, 0.42, 0.8]]), np.array([-1.0, 0.0, 0.0]))
    assert seen == ["ink", "ink"]


def test_no_tags_or_no_such_family_is_one_line(tmp_path: Path, repository: Path, capsys: pytest.CaptureFixture) -> None:
    with pytest.raises(RenderError, match="expected one of DICT"):
        tagged_surface(bundle({7: WALL}), "DICT_9X9")
    with pytest.raises(RenderError, match="unknown identity 400"):
        tagged_surface(bundle({400: WALL}), FAMILY)
    frigate, pen = (str(repository / "data" / name / "target.toml") for name in ("frigate", "marker_pen"))
    out = ["-o", str(tmp_path / "mesh.ply")]
    for arguments in (["--target", frigate, "--dictionary", FAMILY], ["--target", pen]):
        assert main(["render", "tags", *arguments, *out]) == 2
        assert capsys.readouterr().err.count("\n") == 1
    assert not (tmp_path / "mesh.ply").exists()


def test_the_pen_that_comes_along_is_what_its_command_makes(repository: Path, tmp_path: Path) -> None:
    arguments = ["--dictionary", FAMILY, "--quiet", "1.4", "--handle", "0", "-0.15", "-0.004"]
    pen, made = repository / "data" / "marker_pen", tmp_path / "pen.ply"
    assert main(["render", "tags", "--target", str(pen / "target.toml"), *arguments, "-o", str(made)]) == 0
    assert made.read_bytes() == (pen / "pen.ply").read_bytes()


def test_the_detector_finds_the_rendered_pen(graphics: None, shipped: Callable[[str], Shipped]) -> None:
    """All eight tags, from eight sides, where the landmarks are projected to: it knows nothing of the mesh."""
    from fairlead.render.raster.model import Shot
    from fairlead.render.raster.renderer import Renderer
    from fairlead.render.raster.vertices import pack
    from fairlead.render.room import in_a_room
    from fairlead.render.sensor import Sensor, develop, exposure_for

    pen, camera = shipped("marker_pen"), pinhole(512, 900.0)
    renderer = Renderer(512, 512)
    model = renderer.add(pack(pen.surface))
    room = in_a_room(np.random.default_rng(3))
    renderer.set_surroundings(room)
    detector, found, errors = TagDetector(FAMILY), set[str](), list[np.ndarray]()
    for k in range(8):
        eye = pen.target.positions.mean(axis=0) + 0.2 * direction(0.25 * np.pi * k, 0.2)[[0, 2, 1]]
        T = look_at(eye[None], pen.target.positions.mean(axis=0))[0]
        image = renderer.draw(Shot(camera=camera, T_camera_target=T, T_world_target=np.eye(4)), model)
        sensor = Sensor(exposure=exposure_for(room.metered), read_noise=2.0, full_well=5e4)
        picture = develop(image.radiance, sensor, np.random.default_rng(k))
        view = detector.detect(np.ascontiguousarray(picture[..., ::-1]), k, k)
        rows = [pen.target.landmarks.index(name) for name in view.landmarks]
        drawn = geometry.project(camera, geometry.transform(T, pen.target.positions[rows]))
        errors += list(np.linalg.norm(view.pixels - drawn, axis=1))
        found |= set(view.landmarks)
    assert found == set(pen.target.landmarks)
    # Tags of 60 px, drawn with four samples an edge: docs/fiducials.md section 5 says 0.03 to 0.1 px.
    assert np.median(errors) < 0.15
