# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The sea near the target: a mesh that is even in the image, displaced by the waves, with foam and roughness.

What the mesh is too coarse for becomes roughness, as in the fast renderer, so that both meet without a seam.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from fairlead import geometry
from fairlead.render.noise import Tile, fractal_tile, sample_tile
from fairlead.render.ocean import Waves
from fairlead.render.raster.model import Shot
from fairlead.render.surroundings import Surroundings
from fairlead.render.wake import Hull, WakeMap, half_breadth_at

FULL_M, NONE_M = 6.0, 60.0
"""Distance from the hull up to which this sea is seen alone, and from which on not at all [m]."""
FINEST_M = (60.0, 13.0, 3.0, 0.5)
"""A tile is carried by a mesh that is finer than a quarter of this, and not by one as coarse as this [m]."""
MAX_VERTICES = 300_000

Grid = Float64[np.ndarray, "r c 3"]


@dataclass(frozen=True, kw_only=True, eq=False)
class SeaPatch:
    """Vertices in world axes, row after row, and what the material wants of each."""

    vertices: Grid
    foam: np.ndarray
    rough: np.ndarray
    near: np.ndarray


def image_box(shot: Shot, hull: Hull, top_m: float) -> tuple[int, int, int, int] | None:
    """First and last-but-one column and row of what hull, masts and near sea fill; None if that is outside."""
    x = np.array([hull.stern - NONE_M, hull.bow + NONE_M])
    y = np.array([-1.0, 1.0]) * (0.5 * hull.beam + NONE_M)
    corners = np.array([[a, b, z] for a in x for b in y for z in (-2.0, 2.0)])
    high = np.array([[a, b, top_m + 2.0] for a in (hull.stern, hull.bow) for b in 0.5 * hull.beam * np.array([-1, 1])])
    p = geometry.transform(shot.T_camera_target, np.concatenate([corners, high]))
    W, H = shot.camera.width, shot.camera.height
    if p[:, 2].max() <= 0.0:
        return None
    if p[:, 2].min() <= 1.0:
        return (0, 0, W, H)
    pixels = geometry.project(shot.camera, p)
    low = np.clip(np.floor(pixels.min(axis=0)).astype(int) - 4, 0, [W, H])
    high_px = np.clip(np.ceil(pixels.max(axis=0)).astype(int) + 5, 0, [W, H])
    if (high_px - low).min() <= 0:
        return None
    return (int(low[0]), int(low[1]), int(high_px[0]), int(high_px[1]))


def make_patch(
    shot: Shot, box: tuple[int, int, int, int], waves: Waves, surroundings: Surroundings, hull: Hull, foam: Tile
) -> SeaPatch | None:
    """The sea in a box of the image; None if all of that is sky."""
    flat = _flat_grid(shot, box)
    if flat is None:
        return None
    rows = np.linalg.norm(np.gradient(flat, axis=0), axis=2)
    columns = np.linalg.norm(np.gradient(flat, axis=1), axis=2)
    spacing = rows**0.35 * columns**0.65
    T_target_world = geometry.inverse(shot.T_world_target)
    local = flat.reshape(-1, 3) @ T_target_world[:3, :3].T + T_target_world[:3, 3]
    x, y = local[:, 0].reshape(spacing.shape), local[:, 1].reshape(spacing.shape)
    wake = np.zeros((*spacing.shape, 3)) if surroundings.wake is None else _wake(surroundings.wake, x, y)
    calm = 1.0 - 0.55 * wake[..., 0]
    displaced, variance, squeeze = _displaced(flat, spacing, waves)
    vertices = flat + displaced * calm[..., None]
    off = np.hypot(
        np.maximum(np.maximum(hull.stern - x, x - hull.bow), 0.0),
        np.maximum(np.abs(y) - half_breadth_at(hull, x), 0.0),
    )
    share = np.clip((NONE_M - off) / (NONE_M - FULL_M), 0.0, 1.0)
    return SeaPatch(
        vertices=vertices,
        foam=foam_cover(wake[..., 0], squeeze, waves.breaking, flat, foam),
        rough=(2.0 * variance * calm) ** 0.25,
        near=share * share * (3.0 - 2.0 * share),
    )


def _flat_grid(shot: Shot, box: tuple[int, int, int, int]) -> Grid | None:
    """Where rays through the box meet z = 0, rows from far to near."""
    x0, y0, x1, y1 = box
    step = max(0.5, float(np.sqrt((x1 - x0) * (y1 - y0) / MAX_VERTICES)))
    K, R = shot.camera.K, shot.T_camera_world[:3, :3]
    v, u = np.meshgrid(np.arange(y0 - 2.0, y1 + 2.0, step), np.arange(x0 - 2.0, x1 + 2.0, step), indexing="ij")
    rays = np.stack([(u - K[0, 2]) / K[0, 0], (v - K[1, 2]) / K[1, 1], np.ones_like(u)], axis=-1) @ R
    below = (rays[..., 2] < -0.004).all(axis=1)
    if below.sum() < 2:
        return None
    rays = rays[below]
    return shot.eye + rays * (-shot.eye[2] / rays[..., 2:])


def _wake(wake: tuple[WakeMap, WakeMap], x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """The fine map inside its box, the coarse one elsewhere."""
    near, far = wake
    edge_x = np.minimum(x - near.x[0], near.x[1] - x) / (0.06 * (near.x[1] - near.x[0]))
    edge_y = np.minimum(y - near.y[0], near.y[1] - y) / (0.06 * (near.y[1] - near.y[0]))
    inside = (np.clip(edge_x, 0.0, 1.0) * np.clip(edge_y, 0.0, 1.0))[..., None]
    return far.sample(x, y) * (1.0 - inside) + near.sample(x, y) * inside


def _displaced(flat: Grid, spacing: np.ndarray, waves: Waves) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Displacement by the tiles that the mesh can carry, variance of the slopes of the rest, squeeze of all."""
    total = np.zeros_like(flat)
    variance = np.full(spacing.shape, 0.0012 + 0.0006 * waves.wind_m_s)
    squeeze = np.zeros(spacing.shape)
    for tile, finest in zip(waves.tiles, FINEST_M, strict=True):
        c, s = np.cos(tile.turn_rad), np.sin(tile.turn_rad)
        u = (c * flat[..., 0] + s * flat[..., 1]) / tile.side_m
        v = (-s * flat[..., 0] + c * flat[..., 1]) / tile.side_m
        carried = np.clip((finest - spacing) / (0.75 * finest), 0.0, 1.0)
        part = sample_tile(np.concatenate([tile.displacement, tile.squeeze[..., None]], axis=2), u, v)
        total += carried[..., None] * part[..., :3]
        squeeze += carried * part[..., 3]
        variance += (1.0 - carried**2) * 0.5 * float((tile.slope**2).sum(axis=2).mean())
    return total, variance, squeeze


def foam_cover(wake: np.ndarray, squeeze: np.ndarray, breaking: float, flat: Grid, tile: Tile) -> np.ndarray:
    """How much of the water is white: the same as in background.frag."""
    x, y = flat[..., 0], flat[..., 1]
    bubbles = 0.4 * sample_tile(tile, x / 61.0, y / 61.0) + 0.35 * sample_tile(tile, x / 17.0, y / 17.0)
    bubbles = bubbles + 0.25 * sample_tile(tile, x / 4.3, y / 4.3)
    cap = _smooth(breaking, 1.5 * breaking, squeeze) * _smooth(0.35, 0.6, bubbles)
    level = 1.0 - wake
    trail = _smooth(level - 0.30, level + 0.22, 0.5 + 1.9 * (bubbles - 0.5)) * _smooth(0.02, 0.12, wake)
    return np.clip(np.maximum(0.85 * cap, trail), 0.0, 1.0)


def foam_tile() -> Tile:
    """The tile that raster/textures.py gives to the programs."""
    return fractal_tile(512, 1.8, np.random.default_rng(7))


def _smooth(low: np.ndarray | float, high: np.ndarray | float, value: np.ndarray) -> np.ndarray:
    t = np.clip((value - low) / (np.asarray(high) - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)
