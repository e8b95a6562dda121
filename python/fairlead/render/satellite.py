# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The satellite of data/satellite: the second target, to show that nothing here is about ships alone.

x along the docking axis, out of the docking ring; y along the solar wings; z towards the dish [m]; the origin is the
middle of the bus.
"""

import numpy as np

from fairlead.render.modelling import Modeller
from fairlead.render.surface import Material, Surface

MATERIALS = (
    Material(name="foil", colour=(0.62, 0.40, 0.10), roughness=0.35),
    Material(name="white", colour=(0.72, 0.72, 0.70), roughness=0.6),
    Material(name="cells", colour=(0.015, 0.022, 0.07), roughness=0.25),
    Material(name="frame", colour=(0.48, 0.49, 0.50), roughness=0.4),
    Material(name="ring", colour=(0.30, 0.31, 0.32), roughness=0.35),
    Material(name="black", colour=(0.02, 0.02, 0.02), roughness=0.6),
    Material(name="nozzle", colour=(0.12, 0.10, 0.09), roughness=0.45),
)
SIDES = (1, -1)


def build_satellite() -> Surface:
    """Bus, docking ring, two solar wings, dish, thrusters, star trackers."""
    m = Modeller(MATERIALS)
    _add_bus(m)
    _add_ring(m)
    for side in SIDES:
        _add_wing(m, side)
    _add_dish(m)
    return m.surface()


def _add_bus(m: Modeller) -> None:
    m.block("foil", (-1.2, 1.2), (-0.9, 0.9), (-1.0, 1.0))
    for y in SIDES:
        for z in SIDES:  # corner posts, seen on every edge of the bus
            ys, zs = sorted((y * 0.86, y * 0.92)), sorted((z * 0.96, z * 1.02))
            m.block("frame", (-1.22, 1.22), (ys[0], ys[1]), (zs[0], zs[1]))
    m.block("white", (-0.9, 0.5), (-0.92, 0.92), (-0.7, 0.3))
    m.rod("nozzle", (-1.2, 0.0, 0.0), (-1.75, 0.0, 0.0), 0.16, 0.36, 20)
    for y in SIDES:
        for z in SIDES:
            m.rod("nozzle", (-1.2, y * 0.7, z * 0.75), (-1.38, y * 0.76, z * 0.82), 0.05, 0.09, 10)
            m.rod("black", (1.0, y * 0.55, z * 1.0), (1.02, y * 0.55, z * 1.14), 0.07, 0.09, 10)
    m.rod("black", (0.3, -0.5, 1.0), (0.45, -0.62, 1.32), 0.11, 0.14, 14)
    m.rod("black", (0.3, 0.5, 1.0), (0.45, 0.62, 1.32), 0.11, 0.14, 14)
    m.block("black", (1.2, 1.26), (-0.84, -0.66), (-0.12, 0.12))


def _add_ring(m: Modeller) -> None:
    """A docking ring of 1.2 m on a collar; its rim at x = 1.55 m holds four landmarks."""
    angles = 2.0 * np.pi * np.arange(32) / 32
    profile = ((1.2, 0.62), (1.45, 0.62), (1.45, 0.66), (1.55, 0.66), (1.55, 0.60), (1.5, 0.54), (1.25, 0.52))
    rings = [
        np.column_stack([np.full(32, x), radius * np.cos(angles), radius * np.sin(angles)]) for x, radius in profile
    ]
    m.loft("ring", rings, first=False, last=False)
    m.polygons("black", rings[-1], [range(32)])
    for k in range(3):
        angle = 2.0 * np.pi * k / 3 + np.pi / 6
        y, z = 0.56 * np.cos(angle), 0.56 * np.sin(angle)
        m.rod("frame", (1.3, y, z), (1.72, 0.86 * y, 0.86 * z), 0.07, 0.03, 8)


def _add_wing(m: Modeller, side: int) -> None:
    """Three panels on a yoke; the outer corners are landmarks."""
    m.rod("frame", (0.0, side * 0.9, 0.0), (0.0, side * 1.7, 0.0), 0.06)
    for k in range(3):
        low, high = sorted((side * (1.7 + 1.5 * k), side * (3.14 + 1.5 * k)))
        m.block("frame", (-0.8, 0.8), (low, high), (-0.025, 0.015))
        for row in range(4):
            for column in range(4):
                x = -0.76 + 0.385 * row
                y = low + 0.04 + 0.345 * column
                m.block("cells", (x, x + 0.365), (y, y + 0.325), (0.015, 0.025))
        m.rod("frame", (0.0, side * (3.1 + 1.5 * k), 0.0), (0.0, side * (3.25 + 1.5 * k), 0.0), 0.04)


def _add_dish(m: Modeller) -> None:
    angles = 2.0 * np.pi * np.arange(28) / 28
    centre = np.array([-0.5, 0.0, 1.28])
    radii = (0.06, 0.25, 0.42, 0.55)
    rings = [
        centre + np.column_stack([r * np.cos(angles), r * np.sin(angles), np.full(28, 0.55 * r * r)]) for r in radii
    ]
    back = [ring - [0.0, 0.0, 0.02] for ring in rings[::-1]]
    m.loft("white", [*back, *rings])
    m.rod("frame", (-0.5, 0.0, 1.0), (-0.5, 0.0, 1.27), 0.07)
    m.rod("frame", (-0.5, 0.0, 1.28), (-0.5, 0.0, 1.68), 0.02, 0.03, 8)
