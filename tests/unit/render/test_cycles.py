# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Full quality: what can be judged without Blender, and one tiny frame where there is one."""

import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from fairlead import geometry
from fairlead.io.coco import read_coco
from fairlead.render.cycles.blender import load_blender
from fairlead.render.cycles.materials import environment_pixels
from fairlead.render.cycles.sea import foam_cover, image_box, make_patch
from fairlead.render.errors import RenderError
from fairlead.render.flights import Swell, fly
from fairlead.render.frame_files import load_linear
from fairlead.render.job import Job
from fairlead.render.noise import fractal_tile
from fairlead.render.ocean import WaveField
from fairlead.render.raster.model import Shot
from fairlead.render.sky import make_sky
from fairlead.render.surroundings import at_sea, waterline
from tests.unit.render.conftest import Shipped, pinhole


def test_the_sky_of_cycles_is_the_sky() -> None:
    """Cycles looks up (1/2 - azimuth / 2 pi, 1/2 + latitude / pi); the sun's side must be where the sun is."""
    azimuth = 1.2
    sky = make_sky(0.15, azimuth, np.random.default_rng(0), cloud=0.0)
    pixels = environment_pixels(sky, np.array([0.1, 0.2, 0.3]), rows=128)
    assert np.allclose(pixels[:60, :, :3], [0.1, 0.2, 0.3])
    brightest = np.unravel_index(pixels[66:, :, 0].argmax(), (62, 256))[1]
    assert (0.5 - (brightest + 0.5) / 256) * 2 * np.pi == pytest.approx(azimuth, abs=0.05)


def shot_of(frigate: Shipped, share: float) -> Shot:
    flight = fly("rendezvous-30", frigate.target, stride=5, swell=Swell())
    placed = flight[int(share * (len(flight) - 1))]
    camera = pinhole(256, 480.0)
    return Shot(camera=camera, T_camera_target=placed.T_camera_target, T_world_target=placed.T_world_target)


def test_the_near_sea_fills_its_box_and_meets_the_hull(frigate: Shipped) -> None:
    shot = shot_of(frigate, 0.9)
    hull = waterline(frigate.surface)
    box = image_box(shot, hull, 32.0)
    assert box is not None
    pixels = geometry.project(shot.camera, geometry.transform(shot.T_camera_target, frigate.target.positions))
    assert (pixels.min(axis=0) > box[:2]).all()
    assert (pixels.max(axis=0) < box[2:]).all()
    rng = np.random.default_rng(0)
    sea = at_sea(frigate.surface, rng, sun_elevation_rad=0.6, sun_azimuth_rad=1.0)
    waves = WaveField(7.5, 2.6, 0).at(3.0)
    patch = make_patch(shot, box, waves, sea, hull, fractal_tile(64, 1.8, rng))
    assert patch is not None
    p = geometry.transform(shot.T_camera_world, patch.vertices.reshape(-1, 3))
    seen = geometry.project(shot.camera, p)
    assert seen.min(axis=0) == pytest.approx(np.array(box[:2]), abs=4.0)
    assert seen.max(axis=0) == pytest.approx(np.array(box[2:]), abs=4.0)
    assert 0.2 < patch.vertices[..., 2].std() < 0.6
    assert patch.near.max() == 1.0
    assert patch.near[:, 0].max() == patch.near[:, -1].max() == 0.0
    assert patch.foam.max() > 0.9


def test_no_foam_without_wake_and_breaking() -> None:
    flat = np.zeros((4, 4, 3))
    tile = fractal_tile(16, 1.8, np.random.default_rng(0))
    assert not foam_cover(np.zeros((4, 4)), np.zeros((4, 4)), 1.0, flat, tile).any()
    assert (foam_cover(np.ones((4, 4)), np.zeros((4, 4)), 1.0, flat, tile) == 1.0).all()


@pytest.mark.parametrize("missing", ["bpy", "OpenEXR"])
def test_what_is_not_installed_is_said_before_anything_is_traced(missing: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("bpy", "OpenEXR"):
        monkeypatch.setitem(sys.modules, module, None if module == missing else ModuleType(module))
    with pytest.raises(RenderError, match=rf"pip install 'fairlead\[render\]'.*{missing}"):
        load_blender()


def test_one_tiny_frame(graphics: None, frigate: Shipped, tmp_path: Path) -> None:
    """Traced twice: the same light; the mask is that of the ray caster where no wave can be."""
    for module in ("bpy", "OpenEXR"):
        pytest.importorskip(module, reason=f"{module} is not installed (fairlead[render] on Python 3.11)")
    from fairlead.render.sequence import render_sequence

    placed = fly("rendezvous-30", frigate.target, stride=5)[-1]
    camera = pinhole(160, 300.0)
    jobs = [
        Job(target=frigate.target, camera=camera, placed=(placed,), folder=tmp_path / name, samples=1)
        for name in ("one", "two")
    ]
    for job in jobs:
        assert render_sequence(job) == 1
    (first, truth), (second, _) = (
        load_linear(job.folder, placed.frame) or pytest.fail("no light was kept") for job in jobs
    )
    assert np.array_equal(first.radiance, second.radiance)
    assert np.isfinite(first.radiance).all()
    depth = frigate.caster.depth(camera, placed.T_camera_target)
    rows, columns = np.nonzero(np.isfinite(depth))
    rays = np.column_stack([(columns - camera.K[0, 2]) / 300.0, (rows - camera.K[1, 2]) / 300.0, np.ones(len(rows))])
    X = geometry.transform(geometry.inverse(placed.T_camera_target), rays * depth[rows, columns][:, None])
    high = X[:, 2] > 3.0
    assert truth.mask[rows[high], columns[high]].mean() > 0.99
    assert (truth.mask & ~np.isfinite(depth)).sum() <= 0.01 * truth.mask.sum()
    dark, bright = np.quantile(first.radiance[truth.mask].mean(axis=1), [0.05, 0.95])
    assert 0.0 < dark < bright < 3.0


def test_crops_at_full_quality_have_the_labels_of_drafts(graphics: None, repository: Path, tmp_path: Path) -> None:
    for module in ("bpy", "OpenEXR"):
        pytest.importorskip(module, reason=f"{module} is not installed (fairlead[render] on Python 3.11)")
    from fairlead.render.command import render

    for quality in ("draft", "full"):
        target = repository / "data" / "frigate" / "target.toml"
        assert render("crops", tmp_path / quality, target=target, quality=quality, samples=1, count=2, size=64) == 2
    labels = [read_coco(tmp_path / quality / "annotations.json")[1] for quality in ("draft", "full")]
    for draft, full in zip(*labels, strict=True):
        assert np.array_equal(draft.pixels, full.pixels)
        assert draft.visibility == full.visibility
        assert np.array_equal(draft.T_camera_target, full.T_camera_target)
