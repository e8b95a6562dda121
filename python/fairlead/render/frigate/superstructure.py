# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What is built on the deck: bridge, masts, funnels, hangar. Corners that are landmarks stand in target.toml."""

from fairlead.render.frigate.hull import DECK
from fairlead.render.modelling import Modeller

SIDES = (1, -1)


def add_bridge(modeller: Modeller) -> None:
    """Three storeys, each drawn in from the one below, bridge windows and wings."""
    m = modeller
    m.block("super", (79.0, 106.7), (-7.8, 7.8), (5.7, 12.2), aft=0.5, fore=2.5, side=0.95, chamfer=4.0, roof="roof")
    m.block("super", (80.8, 102.2), (-6.6, 6.6), (12.2, 15.0), aft=0.4, fore=1.2, side=0.5, chamfer=3.2, roof="roof")
    m.block(
        "super", (88.9, 100.3), (-6.26, 6.26), (15.0, 18.2), aft=0.6, fore=-0.49, side=0.2, chamfer=3.0, roof="roof"
    )
    m.block("window", (90.1, 100.5), (-6.24, 6.24), (16.45, 17.45), fore=-0.15, side=0.062, chamfer=3.0)
    for k in range(9):  # mullions of the front windows
        y = -3.0 + 0.75 * k
        m.block("super", (100.4, 100.68), (y - 0.06, y + 0.06), (16.4, 17.5), fore=-0.12)
    m.block("super", (81.3, 88.9), (-5.3, 5.3), (15.0, 16.8), aft=0.4, side=0.3, roof="roof")
    for s in SIDES:
        outer = sorted((5.9 * s, 9.0 * s))
        m.block("super", (93.34, 97.29), (outer[0], outer[1]), (14.9, 16.1), roof="roof")
        inner = sorted((6.4 * s, 8.8 * s))
        m.block("deck", (93.6, 97.05), (inner[0], inner[1]), (16.1, 16.13))
        for k in range(6):  # windows of the storey below
            x = 83.5 + 2.6 * k
            y = sorted((6.28 * s, 6.45 * s))
            m.block("window", (x, x + 1.2), (y[0], y[1]), (13.4, 14.1))
        m.rod("panel", (105.0, 4.95 * s, 9.9), (105.3, 5.3 * s, 9.98), 1.45)
        m.rod("panel", (83.3, 7.15 * s, 9.6), (83.3, 7.5 * s, 9.65), 1.45)


def add_main_mast(modeller: Modeller) -> None:
    """An enclosed tower with radars, three yards and the pole whose tip is `mast_top`."""
    m = modeller
    m.block("super", (83.9, 89.2), (-2.3, 2.3), (16.8, 23.2), aft=1.2, fore=1.6, side=1.2, roof="roof")
    m.block("super", (83.6, 88.4), (-2.0, 2.0), (22.9, 23.25))
    m.block("super", (85.3, 87.5), (-0.95, 0.95), (23.2, 26.9), aft=0.4, fore=0.6, side=0.45)
    m.rod("black", (86.43, 0.0, 26.9), (86.43, 0.0, 32.0), 0.26, 0.11)
    m.ball("white", (87.9, 0.0, 24.3), 1.1, 14)
    for z, half in ((24.59, 4.93), (26.36, 3.8), (28.6, 2.1)):
        for s in SIDES:
            m.rod("super", (86.33, 0.0, z), (86.33, s * half, z), 0.18, 0.14, 6)
            m.rod("black", (86.33, s * 0.9 * half, z - 0.4), (86.33, s * 0.9 * half, z + 1.3), 0.08, sides=5)
            m.rod("black", (86.33, s * 0.55 * half, z), (86.33, s * 0.55 * half, z + 0.9), 0.08, sides=5)
    m.block("black", (88.7, 89.1), (-2.8, 2.8), (21.0, 21.9))
    m.rod("super", (87.6, 0.0, 20.6), (88.9, 0.0, 21.0), 0.45)
    for s in SIDES:
        m.rod("super", (84.9, 0.0, 22.4), (82.0, s * 3.0, 16.7), 0.18, sides=6)
        m.rod("super", (83.2, s * 4.0, 16.6), (83.2, s * 4.0, 17.4), 0.45)
        m.ball("white", (83.2, s * 4.0, 18.1), 0.9)


def add_midships(modeller: Modeller) -> None:
    """Deckhouse, both funnels with caps and uptakes, and the aft mast with its pole."""
    m = modeller
    m.block("super", (47.4, 79.2), (-5.3, 5.3), (6.1, 10.0), side=0.35, roof="roof")
    for x, top in ((72.5, 18.68), (55.71, 17.6)):  # middle of the cap's top: funnel_fwd, funnel_aft
        m.block("super", (x - 4.3, x + 5.6), (-3.4, 3.4), (10.0, top - 1.4), aft=1.6, fore=2.6, side=0.85, roof="black")
        m.block("black", (x - 2.4, x + 2.6), (-2.2, 2.2), (top - 1.4, top), aft=0.3, fore=0.5, side=0.24)
        for dx, dy in ((-1.25, 0.85), (-1.25, -0.85), (1.25, 0.85), (1.25, -0.85)):
            m.rod("soot", (x + dx, dy, top - 0.4), (x + dx - 0.1, dy, top + 0.35), 0.46, sides=12)
        for s in SIDES:
            for k in range(5):
                y = sorted((s * 2.95, s * 3.06))
                m.block("black", (x - 1.9 + k, x - 1.25 + k), (y[0], y[1]), (12.3, 13.8))
    m.block("super", (48.6, 52.0), (-1.35, 1.35), (10.0, 19.8), aft=0.9, fore=0.9, side=0.75)
    m.rod("black", (50.28, 0.0, 19.8), (50.28, 0.0, 24.52), 0.2, 0.1, 6)
    for z, half in ((20.2, 3.0), (21.9, 1.9)):
        m.rod("super", (50.28, -half, z), (50.28, half, z), 0.13, sides=6)
    m.block("black", (51.4, 51.8), (-2.1, 2.1), (18.4, 19.3))


def add_hangar(modeller: Modeller) -> None:
    """The hangar, whose aft face carries `hangar_p`, `hangar_s` and, between the doors, `hangar_base`."""
    m = modeller
    m.block("super", (26.67, 47.6), (-7.58, 7.58), (DECK, 13.2), aft=0.3, side=0.76, roof="roof")
    for s in SIDES:
        y = sorted((s * 0.9, s * 5.9))
        m.block("door", (26.58, 26.8), (y[0], y[1]), (6.3, 11.4), aft=0.22)
        for k in range(8):
            z = 6.8 + 0.58 * k
            m.block("super", (26.55 + 0.043 * (z - 6.2), 26.9), (y[0], y[1]), (z, z + 0.06))
        m.rod("super", (42.5, s * 4.3, 13.2), (42.5, s * 4.3, 14.3), 0.55)
        m.ball("white", (42.5, s * 4.3, 15.4), 1.3, 14)
    m.rod("white", (32.6, 0.0, 13.2), (32.6, 0.0, 15.2), 0.95, sides=14)
    m.ball("white", (32.6, 0.0, 15.5), 0.95, 14)
    m.rod("black", (32.6, 0.0, 15.0), (30.2, 0.0, 15.4), 0.18, sides=6)
    m.block("super", (27.3, 30.8), (-5.6, -3.2), (13.2, 15.0), side=0.2, roof="roof")
    m.block("window", (27.2, 27.5), (-5.3, -3.5), (13.8, 14.6))
