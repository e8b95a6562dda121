# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A room that never was: a panorama of coloured, grained and striped patches with windows, and the light that it sheds.

It is no picture of any room. It is there so that a network learns to look at the target and at nothing else.
"""

import numpy as np
from jaxtyping import UInt8

from fairlead import geometry
from fairlead.opencv import draw_lines, fill_polygon
from fairlead.opencv.filters import blurred, resized
from fairlead.render.noise import fractal_tile
from fairlead.render.sky import Backdrop, Sky
from fairlead.render.surface_file import to_linear
from fairlead.render.surroundings import Surroundings
from fairlead.render.viewpoints import direction

ROWS, COLUMNS = 1024, 4096
PATCHES = 420
SKY_ROWS, SKY_COLUMNS = 32, 128

Painting = UInt8[np.ndarray, "h w 3"]


def in_a_room(rng: np.random.Generator) -> Surroundings:
    """Soft light from everywhere, most from windows; a lamp or the sun, too, in half of the rooms."""
    picture = to_linear(_painted(rng) / 255.0).astype(np.float32)
    grain = np.tile(fractal_tile(512, rng.uniform(0.6, 2.2), rng) - 0.5, (2, 8))
    coarse = resized(fractal_tile(128, 2.5, rng)[..., None], COLUMNS, ROWS)[..., 0] - 0.5
    picture *= np.exp(rng.uniform(0.2, 1.5) * grain + rng.uniform(0.0, 2.0) * coarse)[..., None]
    picture = _with_windows(picture, rng)
    picture *= np.exp(rng.uniform(-0.4, 0.4) * np.array([1.0, 0.0, -1.0], np.float32))
    picture = blurred(np.ascontiguousarray(picture), float(rng.choice([0.0, rng.uniform(0.3, 5.0)])))
    sky = Sky(
        radiance=_upper_half(picture),
        sun_direction=direction(float(rng.uniform(0.0, 2.0 * np.pi)), float(rng.uniform(0.1, 1.4))),
        sun_irradiance=np.zeros(3),
        overcast=1.0,
    )
    lamp = float(rng.choice([0.0, rng.uniform(0.2, 1.5)]))
    tint = np.exp(0.15 * rng.standard_normal(3))
    return Surroundings(
        kind="room",
        sky=Sky(
            radiance=sky.radiance,
            sun_direction=sky.sun_direction,
            sun_irradiance=lamp * sky.level_irradiance * tint,
            overcast=1.0,
        ),
        weathering=float(rng.uniform(0.0, 0.15)),
        backdrop=picture,
    )


def _painted(rng: np.random.Generator) -> Painting:
    """Wall above, floor or table below, and patches before them, the large ones first."""
    image = np.zeros((ROWS, COLUMNS, 3), np.uint8)
    image[:] = _colour(rng)
    image[int(ROWS * rng.uniform(0.35, 0.65)) :] = _colour(rng)
    sizes = np.sort(np.exp(rng.uniform(np.log(6.0), np.log(500.0), PATCHES)))[::-1]
    for size in sizes:
        centre = rng.uniform(0.0, 1.0, 2) * [COLUMNS, ROWS]
        half = size * np.exp(0.5 * rng.standard_normal(2))
        corners = int(rng.choice([3, 4, 4, 4, 5, 24]))
        angle = 2.0 * np.pi * (np.arange(corners) + 0.5) / corners
        outline = half * np.column_stack([np.cos(angle), np.sin(angle)])
        turn = rng.choice([0.0, rng.uniform(0.0, np.pi)])
        R = geometry.exp_so3(np.array([0.0, 0.0, turn]))[:2, :2]
        fill_polygon(image, centre + outline @ R.T, _colour(rng))
        if rng.random() < 0.3:
            _hatch(image, centre, 0.7 * half, R, rng)
    return image


def _hatch(image: Painting, centre: np.ndarray, half: np.ndarray, R: np.ndarray, rng: np.random.Generator) -> None:
    """Lines of one colour, as boards, slats, writing and woven cloth have them."""
    count = int(rng.integers(2, 14))
    across = np.linspace(-1.0, 1.0, count) * half[1]
    lines = [centre + np.array([[-half[0], y], [half[0], y]]) @ R.T for y in across]
    draw_lines(image, lines, _colour(rng), width=int(rng.integers(1, max(2, int(half[1] / count)))))


def _colour(rng: np.random.Generator) -> tuple[int, int, int]:
    """Most things are grey, brown or pale; some are bright."""
    value = 255.0 * rng.beta(1.2, 1.2)
    strength = rng.choice([0.08, 0.6], p=[0.7, 0.3])
    r, g, b = np.clip(value * np.exp(strength * rng.standard_normal(3)), 2, 253).astype(int).tolist()
    return r, g, b


def _with_windows(picture: Backdrop, rng: np.random.Generator) -> Backdrop:
    """Rectangles that shine, above the floor."""
    for _ in range(int(rng.integers(1, 5))):
        h, w = rng.integers(40, 300, 2)
        top, left = int(rng.uniform(0.05, 0.5) * ROWS), int(rng.integers(0, COLUMNS - w))
        inside = picture[top : top + h, left : left + w]
        picture[top : top + h, left : left + w] = 0.3 * inside + rng.uniform(1.0, 8.0)
    return picture


def _upper_half(picture: Backdrop) -> np.ndarray:
    """As Sky has it: rows dense at the horizon."""
    small = resized(picture, SKY_COLUMNS, 256)
    elevation = ((np.arange(SKY_ROWS) + 0.5) / SKY_ROWS) ** 2
    return np.maximum(small[(127.0 * (1.0 - elevation)).astype(int)], 0.0)
