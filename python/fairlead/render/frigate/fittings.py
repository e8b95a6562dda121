# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What stands about on deck: gun, launcher, boats, rafts, rails, nets, masts for flags, ventilators."""

import numpy as np

from fairlead.render.frigate.hull import DECK, deck_height, half_breadth, hull_point, station
from fairlead.render.modelling import Modeller

SIDES = (1, -1)


def add_foredeck(modeller: Modeller) -> None:
    """Gun with its muzzle at the landmark, vertical launcher, breakwater, anchors, jackstaff."""
    m = modeller
    z = 8.2
    m.rod("super", (118.5, 0.0, z - 0.5), (118.5, 0.0, z + 1.0), 2.1, sides=20)
    m.block("super", (116.4, 120.9), (-1.8, 1.8), (z + 1.0, z + 3.3), aft=0.5, fore=1.8, side=0.75, chamfer=0.7)
    m.rod("super", (119.8, 0.0, z + 2.1), (126.73, 0.0, 11.4), 0.26, 0.17, 10)
    z = 7.4
    m.block("super", (107.3, 114.0), (-3.1, 3.1), (z - 0.8, z + 0.75))
    for k in range(8):
        for y in (-2.1, -0.7, 0.7, 2.1):
            m.block("deck", (107.6 + 0.8 * k, 108.2 + 0.8 * k), (y - 0.5, y + 0.5), (z + 0.75, z + 0.82))
    for s in SIDES:
        x = 123.5
        foot = float(deck_height(np.asarray(station(x, 8.8))))
        wave = [(127.0, 0.0), (x, s * 4.0)]
        lower, upper = ([(px, py, foot + dz) for px, py in wave] for dz in (-0.3, 0.8))
        m.patch("super", [*lower, *upper[::-1]])
        m.rod("black", (129.0, s * 1.2, 9.2), (129.0, s * 1.2, 10.0), 0.5, sides=10)
        m.ball("black", hull_point(0.945, 6.2, s, 0.15), 0.65, 8)
    m.rod("super", (138.0, 0.0, 10.4), (138.6, 0.0, 14.0), 0.08, sides=6)
    m.rod("super", (0.9, 1.0, DECK), (0.2, 1.0, 10.0), 0.08, sides=6)


def add_boats(modeller: Modeller) -> None:
    """A boat in davits, rafts and missile canisters on each side."""
    m = modeller
    along = np.linspace(-3.7, 3.7, 11)
    width = np.sqrt(np.clip(1.0 - (np.abs(along) / 4.1) ** 3, 0.02, 1.0))
    angles = 2.0 * np.pi * np.arange(10) / 10
    for s in SIDES:
        rings = [
            np.column_stack(
                [np.full(10, 65.2 + x), s * 6.8 + 1.2 * w * np.sin(angles), 8.7 + 0.75 * w * -np.cos(angles)]
            )
            for x, w in zip(along, width, strict=True)
        ]
        m.loft("orange", rings)
        for dx in (-2.4, 2.4):
            m.rod("super", (65.2 + dx, s * 5.6, 6.2), (65.2 + dx, s * 5.6, 10.9), 0.18, sides=6)
            m.rod("super", (65.2 + dx, s * 5.6, 10.8), (65.2 + dx, s * 7.2, 11.0), 0.15, sides=6)
        for x in (*np.arange(49.5, 58.0, 1.6), *np.arange(70.2, 77.5, 1.7)):
            m.rod("white", (x, s * 6.0, 7.2), (x + 1.2, s * 6.0, 7.2), 0.42, sides=10)
        m.rod("black", (75.5, s * 5.6, 10.9), (78.2, s * 7.1, 12.4), 0.33)
        for k in range(4):
            m.rod("super", (78.4 - 0.1 * k, -s * 1.0, 10.6 + 0.55 * k), (78.4 - 0.1 * k, s * 4.0, 12.0 + 0.55 * k), 0.3)


def add_rails(modeller: Modeller) -> None:
    """Guard rails along the deck edge and safety nets round the flight deck."""
    m = modeller
    for s in SIDES:
        previous: np.ndarray | None = None
        for x in np.arange(28.0, 113.0, 2.0):
            u = station(float(x), DECK)
            foot = hull_point(u, deck_height(np.asarray(u)), s, -0.15)
            m.rod("super", foot, foot + _up(1.1), 0.04, sides=4)
            if previous is not None:
                for rise in (0.55, 1.1):
                    m.rod("super", previous + _up(rise), foot + _up(rise), 0.03, sides=3)
            previous = foot
        edge = [hull_point(station(float(x), DECK), DECK, s) for x in np.arange(2.0, 26.0, 2.0)]
        net = np.array([0.0, 1.0 * s, 0.15])
        for inner in edge:
            m.rod("super", inner, inner + net, 0.06, sides=4)
        m.rod("super", edge[0] + net, edge[-1] + net, 0.05, sides=4)
        for x in (3.0, 39.0, 105.0, 114.0, 130.0):
            u = station(x, DECK)
            z = float(deck_height(np.asarray(u)))
            y = s * (float(half_breadth(np.asarray(u), np.asarray(z))) - 0.9)
            m.rod("black", (x, y, z), (x, y, z + 0.6), 0.25)


def _up(rise: float) -> np.ndarray:
    return np.array([0.0, 0.0, rise])


def add_clutter(modeller: Modeller, rng: np.random.Generator) -> None:
    """Doors, ventilators and lockers: nothing that is a landmark."""
    m = modeller
    for s in SIDES:
        for x, y in (
            (50.0, 5.3),
            (58.0, 5.3),
            (62.0, 5.3),
            (69.0, 5.3),
            (77.0, 5.3),
            (30.0, 7.56),
            (37.0, 7.56),
            (44.0, 7.56),
        ):
            inner, outer = sorted((s * (y - 0.25), s * (y + 0.02)))
            m.block("door", (x - 0.45, x + 0.45), (inner, outer), (6.4, 8.3), side=0.0)
        for x in (83.0, 91.0, 98.0):
            inner, outer = sorted((s * 7.3, s * 7.68))
            m.block("door", (x - 0.45, x + 0.45), (inner, outer), (7.0, 8.9))
    for low, high, half, base, count in ((48.5, 78.0, 4.7, 9.9, 26), (33.5, 46.5, 5.6, 13.1, 14)):
        for _ in range(count):
            x, y = rng.uniform(low, high), rng.uniform(-half, half)
            length, height = rng.uniform(0.3, 0.8), rng.uniform(0.4, 1.1)
            width = 0.8 * length
            m.block("super", (x - length, x + length), (y - width, y + width), (base, base + 0.1 + height))
