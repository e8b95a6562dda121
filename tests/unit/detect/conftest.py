# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Drawn tags and boards whose corners are known exactly."""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
import pytest

SUPER = 4
"""Drawn at this many times the resolution."""
FAMILY = "DICT_4X4_100"


@dataclass(frozen=True, kw_only=True)
class Optics:
    """What lies between the print and the pixel values."""

    blur_px: float = 0.8
    motion_px: tuple[float, float] = (0.0, 0.0)
    gamma: float = 1.0
    """Pixel value = light^(1 / gamma)."""
    noise: float = 2.0
    """Grey levels, one standard deviation."""


@dataclass(frozen=True, kw_only=True)
class Drawing:
    """A grey image and where the corners truly are."""

    image: np.ndarray
    corners: np.ndarray


def random_quad(rng: np.random.Generator, side_px: float, centre: float, tilt: float) -> np.ndarray:
    """A square seen from eight sides away, tilted about both axes and turned at random; clockwise from its top left."""
    a, b, c = rng.uniform(-tilt, tilt), rng.uniform(-tilt, tilt), rng.uniform(0.0, 2.0 * np.pi)
    about_x = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    about_y = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    about_z = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]])
    square = np.array([[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0]])
    points = square @ (about_x @ about_y @ about_z).T + [0.0, 0.0, 8.0]
    return 8.0 * side_px * points[:, :2] / points[:, 2:] + centre + rng.uniform(-0.5, 0.5, 2)


def homography(quad: np.ndarray) -> np.ndarray:
    """From the unit square to the quadrilateral, by the null space of the direct linear transform."""
    rows = []
    for (u, v), (x, y) in zip([(0, 0), (1, 0), (1, 1), (0, 1)], quad, strict=True):
        rows += [[u, v, 1, 0, 0, 0, -u * x, -v * x, -x], [0, 0, 0, u, v, 1, -u * y, -v * y, -y]]
    return np.linalg.svd(np.array(rows))[2][-1].reshape(3, 3)


def expose(
    pattern: Callable[[np.ndarray, np.ndarray], np.ndarray],
    H: np.ndarray,
    size: int,
    optics: Optics,
    rng: np.random.Generator,
) -> np.ndarray:
    """The image of a pattern of the unit square; `pattern` gives the light at (u, v), 0 to 1, also outside of it."""
    fine = (np.arange(size * SUPER) + 0.5) / SUPER - 0.5
    x, y = np.meshgrid(fine, fine)
    u, v, w = np.moveaxis(np.stack([x, y, np.ones_like(x)], axis=-1) @ np.linalg.inv(H).T, -1, 0)
    light = 0.05 + 0.7 * pattern(u / w, v / w)
    light = cv2.GaussianBlur(light, (0, 0), optics.blur_px * SUPER)
    length = np.hypot(*optics.motion_px)
    if length > 0.0:
        steps = np.linspace(-0.5, 0.5, int(length * SUPER) + 2)
        moved = [
            np.float32([[1, 0, t * SUPER * optics.motion_px[0]], [0, 1, t * SUPER * optics.motion_px[1]]])
            for t in steps
        ]
        light = np.mean(
            [cv2.warpAffine(light, M, light.shape[::-1], borderMode=cv2.BORDER_REPLICATE) for M in moved], axis=0
        )
    light = light.reshape(size, SUPER, size, SUPER).mean(axis=(1, 3))
    values = 255.0 * light ** (1.0 / optics.gamma) + optics.noise * rng.standard_normal(light.shape)
    return np.clip(np.rint(values), 0, 255).astype(np.uint8)


def draw_tag(
    rng: np.random.Generator, identity: int, *, side_px: float, optics: Optics, tilt: float = 0.6, size: int = 160
) -> Drawing:
    """A tag with a quiet zone of one cell on a grey wall."""
    quad = random_quad(rng, side_px, 0.5 * size, tilt)
    cells = (
        cv2.aruco.generateImageMarker(cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, FAMILY)), identity, 6)
        / 255.0
    )

    def pattern(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        column, row = np.floor(6 * u), np.floor(6 * v)
        tag = (column >= 0) & (column < 6) & (row >= 0) & (row < 6)
        quiet = (column >= -1) & (column < 7) & (row >= -1) & (row < 7)
        printed = cells[np.clip(row, 0, 5).astype(int), np.clip(column, 0, 5).astype(int)]
        return np.where(tag, printed, np.where(quiet, 1.0, 0.3))

    return Drawing(image=expose(pattern, homography(quad), size, optics, rng), corners=quad)


def draw_board(
    rng: np.random.Generator, *, columns: int, rows: int, side_px: float, optics: Optics, size: int = 280
) -> Drawing:
    """A chessboard of columns x rows squares, the first one black, and its inner corners row by row."""
    H = homography(random_quad(rng, side_px, 0.5 * size, 0.5))

    def pattern(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        column, row = np.floor(columns * u), np.floor(rows * v)
        inside = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        return np.where(inside, (column + row) % 2, 1.0)

    grid = [[i / columns, j / rows, 1.0] for j in range(1, rows) for i in range(1, columns)]
    z = np.array(grid) @ H.T
    return Drawing(image=expose(pattern, H, size, optics, rng), corners=z[:, :2] / z[:, 2:])


class Studio:
    """The drawing functions, for tests."""

    optics = Optics
    tag = staticmethod(draw_tag)
    board = staticmethod(draw_board)


@pytest.fixture(scope="session")
def studio() -> Studio:
    return Studio()


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20261122)
