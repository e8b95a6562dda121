# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What is in a picture and is not the target: other ships, an island. Origin on the waterline, z up [m]."""

import numpy as np

from fairlead.render.modelling import Modeller
from fairlead.render.noise import fractal_tile, sample_tile
from fairlead.render.surface import Material, Surface


def container_ship(rng: np.random.Generator) -> Surface:
    """A long hull under stacks of boxes, the bridge aft."""
    hull = Material(name="hull", colour=tuple(rng.uniform(0.02, 0.35, 3).tolist()))
    boxes = [Material(name=f"box{k}", colour=tuple(rng.uniform(0.03, 0.5, 3).tolist())) for k in range(5)]
    white = Material(name="white", colour=(0.6, 0.6, 0.58))
    m = Modeller([hull, white, *boxes])
    length, beam = rng.uniform(120.0, 300.0), rng.uniform(20.0, 36.0)
    half = 0.5 * beam
    m.block("hull", (0.0, length), (-half, half), (-4.0, 0.07 * length), fore=-0.03 * length, chamfer=0.45 * beam)
    top = 0.07 * length
    m.block("white", (0.06 * length, 0.12 * length), (-half, half), (top, top + 0.12 * length), side=0.1)
    for k in range(8):
        x = length * (0.15 + 0.09 * k)
        height = rng.uniform(0.01, 0.07) * length
        name = f"box{rng.integers(5)}"
        m.block(name, (x, x + 0.08 * length), (-0.92 * half, 0.92 * half), (top, top + height))
    return m.surface()


def small_craft(rng: np.random.Generator) -> Surface:
    """A boat of 12 to 45 m with a deckhouse and a mast."""
    hull = Material(name="hull", colour=tuple((rng.uniform(0.1, 0.6) * rng.uniform(0.7, 1.0, 3)).tolist()))
    white = Material(name="white", colour=(0.65, 0.65, 0.63))
    dark = Material(name="dark", colour=(0.03, 0.03, 0.04), roughness=0.3)
    m = Modeller([hull, white, dark])
    length = rng.uniform(12.0, 45.0)
    half = 0.11 * length
    deck = 0.08 * length
    m.block("hull", (0.0, length), (-half, half), (-1.0, deck), fore=-0.04 * length, chamfer=0.8 * half)
    m.block("white", (0.2 * length, 0.6 * length), (-0.7 * half, 0.7 * half), (deck, 2.2 * deck), fore=0.05 * length)
    m.block(
        "dark",
        (0.45 * length, 0.601 * length),
        (-0.71 * half, 0.71 * half),
        (1.5 * deck, 1.9 * deck),
        fore=0.02 * length,
    )
    m.rod("white", (0.4 * length, 0.0, 2.0 * deck), (0.38 * length, 0.0, 4.0 * deck), 0.012 * length)
    return m.surface()


def island(rng: np.random.Generator) -> Surface:
    """Hills out of fractal noise, 2 to 5 km across, falling into the sea all round."""
    land = [
        Material(name="rock", colour=(0.12, 0.10, 0.08), roughness=0.9),
        Material(name="green", colour=(0.035, 0.06, 0.025), roughness=0.9),
        Material(name="sand", colour=(0.30, 0.26, 0.19), roughness=0.9),
    ]
    size, count = rng.uniform(1000.0, 2500.0), 56
    tile = fractal_tile(128, 3.2, rng)
    x, y = np.meshgrid(np.linspace(-1.0, 1.0, count), np.linspace(-1.0, 1.0, count))
    shape = np.clip(1.0 - (x * x + (1.7 * y) ** 2), 0.0, 1.0)
    height = rng.uniform(80.0, 320.0) * (shape * (0.4 + 1.2 * sample_tile(tile, 0.35 * x, 0.35 * y)) - 0.12)
    m = Modeller(land)
    grid = np.stack([size * x, 0.7 * size * y, height], axis=-1)
    for row in range(count - 1):
        for name, low, high in (("sand", -1e9, 6.0), ("green", 6.0, 120.0), ("rock", 120.0, 1e9)):
            level = height[row : row + 2, :]
            cells = [
                c
                for c in range(count - 1)
                if low <= float(level[:, c : c + 2].mean()) < high and level[:, c : c + 2].max() > -8.0
            ]
            for c in cells:
                m.patch(name, [grid[row, c], grid[row, c + 1], grid[row + 1, c + 1], grid[row + 1, c]])
    return m.surface()
