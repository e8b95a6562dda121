# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Depth and visibility by ray casting, judged by hand-computed scenes and by the projection of landmarks."""

from collections.abc import Callable

import numpy as np
import pytest

from fairlead import geometry
from fairlead.render.raycast import HIDDEN_TOLERANCE, RayCaster
from fairlead.render.surface import Material, Surface
from fairlead.render.viewpoints import look_at
from fairlead.types import Camera
from tests.unit.render.conftest import Shipped, pinhole


def square(z: float, half: float) -> Surface:
    """A square across the z axis."""
    corners = np.array([[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]])
    return Surface(
        vertices=corners,
        faces=np.array([[0, 1, 2], [0, 2, 3]]),
        materials=(Material(name="grey", colour=(0.5, 0.5, 0.5)),),
        material_of_face=np.zeros(2, dtype=np.int64),
    )


def test_depth_of_a_square_pins_the_pixel_centres() -> None:
    """f = 10 px at 10 m: one pixel is one metre. Edges at +-2.4 m: pixels -2..2 about the principal point (5, 5)."""
    pytest.importorskip("embreex")
    caster = RayCaster(square(10.0, 2.4))
    camera = Camera(
        name="c",
        width=11,
        height=11,
        model="pinhole",
        K=np.array([[10.0, 0, 5], [0, 10.0, 5], [0, 0, 1]]),
        distortion=np.zeros(0),
    )
    depth = caster.depth(camera, np.eye(4))
    rows, columns = np.nonzero(np.isfinite(depth))
    assert (rows.min(), rows.max(), columns.min(), columns.max()) == (3, 7, 3, 7)
    assert np.allclose(depth[3:8, 3:8], 10.0, atol=1e-12)


def test_far_away_is_as_exact_as_near(frigate: Shipped) -> None:
    """Single precision at 30 km would be off by 4 mm; rays start at the surface, and the plane is met in double."""
    X = frigate.target.positions
    direction = np.array([-0.9, 0.3, 0.3]) / np.linalg.norm([-0.9, 0.3, 0.3])
    for range_m in (300.0, 30_000.0):
        covered = frigate.caster.covered(X.mean(axis=0) + range_m * direction, X)
        # Single precision of a ray that starts 150 m away, met under 10 degrees: 150 x 1.2e-7 / sin 10 deg.
        on_top = covered[frigate.target.landmarks.index("mast_top")]
        assert on_top < 1e-3


def test_what_hides_a_landmark_does_so_by_far(frigate: Shipped) -> None:
    """The tolerance lies in a gap: hardly any landmark is covered by between a half and twice of it."""
    rng = np.random.default_rng(1)
    covered: list[np.ndarray] = []
    for _ in range(300):
        azimuth, elevation = rng.uniform(0.0, 2 * np.pi), np.radians(rng.uniform(2.0, 40.0))
        direction = np.array(
            [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
        )
        covered.append(frigate.caster.covered(70.0 + 1500.0 * direction, frigate.target.positions))
    shares = np.concatenate(covered) / frigate.surface.diameter
    near = (shares > 0.5 * HIDDEN_TOLERANCE) & (shares < 2.0 * HIDDEN_TOLERANCE)
    assert near.mean() < 0.05
    assert (shares > HIDDEN_TOLERANCE).mean() > 0.1


@pytest.mark.parametrize(
    ("azimuth_deg", "hidden", "seen"), [(180.0, "bow", "hangar_base"), (0.0, "hangar_base", "bow")]
)
def test_the_hangar_hides_its_own_foot_from_ahead(azimuth_deg: float, hidden: str, seen: str, frigate: Shipped) -> None:
    a, e = np.radians(azimuth_deg), np.radians(5.0)
    centre = np.array([70.0, 0.0, 0.0]) + 900.0 * np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    visible = dict(zip(frigate.target.landmarks, frigate.caster.visible(centre, frigate.target.positions), strict=True))
    assert visible[seen]
    assert not visible[hidden]


@pytest.mark.parametrize("name", ["frigate", "satellite"])
def test_projected_landmarks_lie_on_their_geometry(name: str, shipped: Callable) -> None:
    """A 60 times finer camera on each visible landmark: some ray within 0.1 px of it meets the surface at its depth."""
    ship = shipped(name)
    D = ship.surface.diameter
    centre = ship.target.positions.mean(axis=0) + D * np.array([-3.0, 1.5, 1.2])
    coarse, factor = pinhole(1024, 1910.0), 60.0
    T = look_at(centre[None], ship.target.positions.mean(axis=0))[0]
    visible = ship.caster.visible(centre, ship.target.positions)
    p = geometry.transform(T, ship.target.positions)
    for position, z in zip(geometry.project(coarse, p)[visible], p[visible, 2], strict=True):
        K = np.diag([1910.0 * factor, 1910.0 * factor, 1.0])
        # (position - cx) of the coarse camera, magnified, is put on the middle of a 13 x 13 image.
        K[:2, 2] = 6.0 - factor * (position - coarse.K[:2, 2])
        fine = Camera(name="fine", width=13, height=13, model="pinhole", K=K, distortion=np.zeros(0))
        depth = ship.caster.depth(fine, T)
        assert np.abs(depth - z).min() < 2e-3 * D
