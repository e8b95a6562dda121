# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The rasteriser against an independent ray caster: masks, depth, half pixels; and what its pictures show."""

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from fairlead import geometry
from fairlead.render.errors import RenderError
from fairlead.render.images import TruthImage
from fairlead.render.ocean import WaveField
from fairlead.render.raster.matrices import check_pinhole, clip_of_camera, rays_of_clip
from fairlead.render.raster.model import Shot
from fairlead.render.raster.vertices import corner_normals, pack
from fairlead.render.sky import make_sky
from fairlead.render.surroundings import Surroundings, at_sea, in_space
from fairlead.render.viewpoints import direction, look_at
from fairlead.types import Camera, Matrix4
from tests.unit.render.conftest import Shipped, pinhole


def test_the_clip_matrix_pins_the_half_pixel() -> None:
    """Centre of the top-left pixel, (0, 0), is half a pixel inside the corner (-1, -1) of clip space."""
    camera = Camera(
        name="c",
        width=8,
        height=4,
        model="pinhole",
        K=np.array([[5.0, 0, 2.5], [0, 6.0, 1.5], [0, 0, 1]]),
        distortion=np.zeros(0),
    )
    matrix = clip_of_camera(camera, 1.0, 100.0)
    rays = np.array([[(0 - 2.5) / 5.0, (0 - 1.5) / 6.0, 1.0], [(7 - 2.5) / 5.0, (3 - 1.5) / 6.0, 1.0]])
    clip = np.column_stack([rays, np.ones(2)]) @ matrix.T
    assert np.allclose(clip[:, :2] / clip[:, 3:], [[-1 + 1 / 8, -1 + 1 / 4], [1 - 1 / 8, 1 - 1 / 4]])
    back = rays_of_clip(camera, np.eye(3)) @ np.array([-1 + 1 / 8, -1 + 1 / 4, 1.0])
    assert np.allclose(back / back[2], rays[0])


def test_a_lens_with_distortion_is_refused() -> None:
    camera = pinhole(16, 20.0)
    with pytest.raises(RenderError, match="expected no distortion"):
        check_pinhole(replace(camera, model="plumb_bob", distortion=np.array([0.1, 0, 0, 0, 0])))


def view(ship: Shipped, azimuth_deg: float, elevation_deg: float, range_m: float) -> Matrix4:
    middle = 0.5 * (ship.target.positions.min(axis=0) + ship.target.positions.max(axis=0))
    eye = middle + range_m * direction(np.radians(azimuth_deg), np.radians(elevation_deg))
    return look_at(eye[None], middle)[0]


def space() -> Surroundings:
    return in_space(np.random.default_rng(0), sun_elevation_rad=0.7, sun_azimuth_rad=1.0)


def iou(a: np.ndarray, b: np.ndarray) -> float:
    return float((a & b).sum() / (a | b).sum())


@pytest.fixture(scope="module")
def truth(graphics: None, shipped: Callable) -> Callable:
    """Mask and depth of a target without a sea, so that ray caster and rasteriser see the same."""
    from fairlead.render.raster.renderer import Renderer

    def draw(name: str, camera: Camera, T: Matrix4) -> TruthImage:
        renderer = Renderer(camera.width, camera.height)
        renderer.set_surroundings(space())
        model = renderer.add(pack(shipped(name).surface))
        return renderer.truth(Shot(camera=camera, T_camera_target=T, T_world_target=np.eye(4)), model)

    return draw


@pytest.mark.parametrize(
    ("name", "azimuth", "elevation", "ranges"),
    [("frigate", 140.0, 15.0, 4.0), ("frigate", 20.0, 40.0, 3.0), ("satellite", 60.0, 25.0, 4.0)],
)
def test_masks_and_depth_are_those_of_the_ray_caster(
    name: str, azimuth: float, elevation: float, ranges: float, shipped: Callable, truth: Callable
) -> None:
    ship = shipped(name)
    camera = pinhole(768, 1910.0)
    T = view(ship, azimuth, elevation, ranges * ship.surface.diameter)
    drawn, depth = truth(name, camera, T), ship.caster.depth(camera, T)
    mask = np.isfinite(depth)
    assert mask.sum() > 5000
    assert iou(drawn.mask, mask) >= 0.999
    for shift in ((0, 1), (1, 0), (0, -1), (-1, 0)):
        assert iou(np.roll(drawn.mask, shift, (0, 1)), mask) < 0.98
    both = drawn.mask & mask
    # Where both meet the same face: single precision of depth, and of places on faces seen at a slant.
    off = np.abs(drawn.depth[both] - depth[both]) / ship.surface.diameter
    assert np.quantile(off, 0.99) < 1e-4


def test_half_a_pixel_is_seen(frigate: Shipped, truth: Callable) -> None:
    """A principal point that is off by half a pixel, either way, costs more than renderer and ray caster differ."""
    camera = pinhole(512, 1910.0)
    T = view(frigate, 140.0, 20.0, 5.0 * frigate.surface.diameter)
    mask = np.isfinite(frigate.caster.depth(camera, T))
    right = iou(truth("frigate", camera, T).mask, mask)
    for half in (-0.5, 0.5):
        K = camera.K.copy()
        K[:2, 2] += half
        assert iou(truth("frigate", replace(camera, K=K), T).mask, mask) < right - 0.01


def test_the_sea_hides_what_is_under_it(graphics: None, frigate: Shipped) -> None:
    from fairlead.render.raster.renderer import Renderer

    camera = pinhole(256, 400.0)
    T = view(frigate, 90.0, 10.0, 400.0)
    renderer = Renderer(256, 256)
    renderer.set_surroundings(sea(frigate))
    renderer.set_waves(WaveField(7.0, 0.3, 1, size=64).at(1.0))
    shot = Shot(camera=camera, T_camera_target=T, T_world_target=np.eye(4))
    seen = renderer.truth(shot, renderer.add(pack(frigate.surface)))
    rows, columns = np.nonzero(seen.mask)
    rays = np.column_stack([(np.column_stack([columns, rows]) - camera.K[:2, 2]) / 400.0, np.ones(len(rows))])
    X = geometry.transform(geometry.inverse(T), rays * seen.depth[seen.mask][:, None].astype(np.float64))
    assert X[:, 2].min() > -0.05
    assert X[:, 2].min() < 0.5


def sea(ship: Shipped, overcast: float = 0.0) -> Surroundings:
    rng = np.random.default_rng(3)
    return at_sea(ship.surface, rng, sun_elevation_rad=0.6, sun_azimuth_rad=2.0, overcast=overcast)


def test_pictures_are_finite_repeatable_and_lit_from_the_sun(graphics: None, frigate: Shipped) -> None:
    from fairlead.render.raster.renderer import Renderer

    renderer = Renderer(128, 128)
    model = renderer.add(pack(frigate.surface))
    waves = WaveField(9.0, 0.3, 1, size=64).at(1.0)
    bright: dict[float, float] = {}
    for side, azimuth in ((1.0, 115.0), (-1.0, -65.0)):  # the sun is at 115 degrees
        camera = pinhole(128, 300.0)
        shot = Shot(camera=camera, T_camera_target=view(frigate, azimuth, 20.0, 500.0), T_world_target=np.eye(4))
        renderer.set_surroundings(sea(frigate))
        renderer.set_waves(waves)
        image = renderer.draw(shot, model)
        assert np.isfinite(image.radiance).all()
        assert image.radiance.min() >= 0.0
        assert np.array_equal(image.radiance, renderer.draw(shot, model).radiance)
        mask = renderer.truth(shot, model).mask
        bright[side] = float(image.radiance[mask].mean())
        distance = image.distance[mask]
        assert 350.0 < float(distance.min()) < float(distance.max()) < 650.0
    assert bright[1.0] > 1.5 * bright[-1.0]


def test_the_sea_does_not_flicker(graphics: None, frigate: Shipped) -> None:
    """From one frame of the 25 Hz camera to the next, waves move and the light of a patch of sea stays."""
    from fairlead.render.raster.renderer import Renderer

    renderer = Renderer(128, 128)
    model = renderer.add(pack(frigate.surface))
    renderer.set_surroundings(sea(frigate))
    field = WaveField(8.0, 0.3, 1)
    shot = Shot(
        camera=pinhole(128, 240.0), T_camera_target=view(frigate, 150.0, 15.0, 2000.0), T_world_target=np.eye(4)
    )
    patches: list[np.ndarray] = []
    for step in range(6):
        renderer.set_waves(field.at(5.0 + 0.04 * step))
        patches.append(renderer.draw(shot, model).radiance[80:120, 20:100].mean(axis=2))
    means = np.array([patch.mean() for patch in patches])
    assert np.abs(np.diff(means)).max() < 0.005 * means.mean()
    following = [np.corrcoef(a.ravel(), b.ravel())[0, 1] for a, b in itertools.pairwise(patches)]
    # One pixel is 8 m across and 32 m along: what is seen of the waves lives for a second.
    assert min(following) > 0.9


def test_the_horizon_is_where_the_earth_curves_away(graphics: None, frigate: Shipped) -> None:
    """From h = 200 m the horizon dips by sqrt(2 h / R) with R = 7.3e6 m, refraction included: 7.4 mrad."""
    from fairlead.render.raster.renderer import Renderer

    renderer = Renderer(64, 256)
    renderer.set_surroundings(replace(sea(frigate), wake=None))
    renderer.set_waves(WaveField(7.0, 0.3, 1, size=64).at(1.0))
    K = np.array([[4000.0, 0, 31.5], [0, 4000.0, 127.5], [0, 0, 1]])
    camera = Camera(name="level", width=64, height=256, model="pinhole", K=K, distortion=np.zeros(0))
    eye = np.array([-3000.0, 5000.0, 200.0])
    T = look_at(eye[None], eye - np.array([100.0, 0.0, 0.0]))[0]
    image = renderer.draw(
        Shot(camera=camera, T_camera_target=T, T_world_target=np.eye(4)), renderer.add(pack(frigate.surface))
    )
    sky_rows = (image.distance > 59_000.0).all(axis=1)
    # The sea there is 54 km away, and its last kilometres are thinner than a pixel.
    assert np.nonzero(sky_rows)[0].max() == pytest.approx(127.5 + 4000.0 * np.sqrt(400.0 / 7.3e6), abs=1.5)


def test_smooth_faces_share_normals_and_creases_do_not(frigate: Shipped) -> None:
    normals = corner_normals(frigate.surface)
    assert np.allclose(np.linalg.norm(normals, axis=2), 1.0, atol=1e-9)
    deck = next(k for k, material in enumerate(frigate.surface.materials) if material.name == "deck")
    flat = frigate.surface.vertices[frigate.surface.faces[frigate.surface.material_of_face == deck]]
    level = np.ptp(flat[..., 2], axis=1) < 1e-6
    assert (np.abs(normals[frigate.surface.material_of_face == deck][level][..., 2]) > 0.8).mean() > 0.9


def test_without_light_there_is_no_picture(graphics: None, frigate: Shipped) -> None:
    from fairlead.render.raster.renderer import Renderer

    renderer = Renderer(16, 16)
    shot = Shot(camera=pinhole(16, 20.0), T_camera_target=np.eye(4), T_world_target=np.eye(4))
    with pytest.raises(ValueError, match="set_surroundings"):
        renderer.draw(shot, renderer.add(pack(frigate.surface)))


def test_low_suns_are_red_and_grey_skies_even() -> None:
    rng = np.random.default_rng(0)
    high, low = (make_sky(np.radians(e), 0.0, rng, cloud=0.0) for e in (60.0, 4.0))
    ratio = [sky.sun_irradiance[0] / sky.sun_irradiance[2] for sky in (high, low)]
    assert ratio[1] > 3.0 * ratio[0]
    assert high.irradiance[2] > high.irradiance[0]
    grey = make_sky(np.radians(40.0), 0.0, rng, overcast=1.0)
    assert np.allclose(grey.sun_irradiance, 0.0)
    # CIE overcast sky: the zenith is three times as bright as the horizon.
    assert grey.radiance[-1].mean() / grey.radiance[0].mean() == pytest.approx(3.0, rel=0.02)
    assert low.level_irradiance < 0.2 * high.level_irradiance
