# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What is in a picture and is not the target: other ships, an island. Origin on the waterline, z up [m].

A ship's x runs from its stern to its bow. No two are alike: a network is to know its target, not some other ships.
"""

from collections.abc import Callable

import numpy as np

from fairlead.render.modelling import Modeller
from fairlead.render.noise import fractal_tile, sample_tile
from fairlead.render.surface import Material, Surface

_WHITE = Material(name="white", colour=(0.62, 0.62, 0.60))
_DARK = Material(name="dark", colour=(0.03, 0.03, 0.04), roughness=0.3)


def other_ship(rng: np.random.Generator) -> Surface:
    """One of the kinds below; every third is grey and built like a warship, which is most easily mistaken."""
    chances = np.array([share for _, share in KINDS])
    return KINDS[int(rng.choice(len(KINDS), p=chances / chances.sum()))][0](rng)


def container_ship(rng: np.random.Generator) -> Surface:
    """A long hull under stacks of boxes, the bridge aft or forward."""
    boxes = [Material(name=f"box{k}", colour=tuple(rng.uniform(0.03, 0.5, 3).tolist())) for k in range(5)]
    m, length, half, top = _hull(rng, (90.0, 300.0), 0.07, boxes)
    bridge = rng.choice([0.06, 0.7])
    m.block("white", (bridge * length, (bridge + 0.06) * length), (-half, half), (top, top + 0.12 * length), side=0.1)
    for k in range(8):
        x = length * (0.15 + 0.09 * k)
        if abs(x - bridge * length) < 0.1 * length:
            continue
        height = rng.uniform(0.01, 0.07) * length
        name = f"box{rng.integers(5)}"
        m.block(name, (x, x + 0.08 * length), (-0.92 * half, 0.92 * half), (top, top + height))
    return m.surface()


def tanker(rng: np.random.Generator) -> Surface:
    """A long flat deck with pipes and cranes, the house aft."""
    m, length, half, top = _hull(rng, (80.0, 250.0), rng.uniform(0.03, 0.07))
    high = rng.uniform(0.08, 0.14) * length
    m.block("white", (0.08 * length, 0.17 * length), (-0.9 * half, 0.9 * half), (top, top + high), fore=0.01 * length)
    m.block("dark", (0.165 * length, 0.171 * length), (-0.8 * half, 0.8 * half), (top + 0.8 * high, top + 0.9 * high))
    m.block("hull", (0.03 * length, 0.06 * length), (-0.2 * half, 0.2 * half), (top, top + high), aft=0.005 * length)
    for x in rng.uniform(0.25, 0.85, int(rng.integers(1, 5))) * length:
        tall = rng.uniform(0.03, 0.08) * length
        m.rod("white", (x, 0.0, top), (x, 0.0, top + tall), 0.006 * length)
        if rng.random() < 0.7:
            end = x + rng.choice([-1.0, 1.0]) * rng.uniform(0.05, 0.1) * length
            m.rod("white", (x, 0.0, top + 0.9 * tall), (end, 0.0, top + rng.uniform(0.5, 1.4) * tall), 0.004 * length)
    for y in rng.uniform(-0.6, 0.6, 3) * half:
        m.rod("dark", (0.2 * length, y, top + 1.0), (0.9 * length, y, top + 1.0), 0.5)
    return m.surface()


def ferry(rng: np.random.Generator) -> Surface:
    """Decks of cabins over most of the hull, rows of windows, a funnel."""
    m, length, half, top = _hull(rng, (40.0, 220.0), rng.uniform(0.06, 0.1))
    aft, fore, storey = rng.uniform(0.02, 0.2), rng.uniform(0.8, 0.93), rng.uniform(0.018, 0.03) * length
    for _ in range(int(rng.integers(2, 6))):
        x, y = (aft * length, fore * length), (-0.97 * half, 0.97 * half)
        m.block("white", x, y, (top, top + storey), fore=0.01 * length, chamfer=0.3 * half)
        m.block(
            "dark",
            (x[0] + 1.0, x[1] - 0.02 * length),
            (-0.985 * half, 0.985 * half),
            (top + 0.45 * storey, top + 0.7 * storey),
        )
        aft, fore, top = aft + rng.uniform(0.0, 0.08), fore - rng.uniform(0.0, 0.08), top + storey
    x, side = rng.uniform(0.15, 0.5) * length, 0.04 * length
    m.block(
        "hull", (x, x + 2.0 * side), (-0.3 * half, 0.3 * half), (top, top + rng.uniform(1.5, 3.0) * storey), fore=side
    )
    m.rod("white", (0.7 * length, 0.0, top), (0.68 * length, 0.0, top + 3.0 * storey), 0.004 * length)
    return m.surface()


def warship(rng: np.random.Generator) -> Surface:
    """Grey; blocks drawn in towards the top, masts with yards, a gun, a flight deck or none."""
    m, length, half, top = _hull(rng, (35.0, 190.0), rng.uniform(0.035, 0.06), grey=True)
    x = rng.uniform(0.12, 0.35) * length
    while x < 0.72 * length:
        long, high = rng.uniform(0.06, 0.22) * length, rng.uniform(0.02, 0.08) * length
        end, width = min(x + long, 0.8 * length), rng.uniform(0.55, 1.0) * half
        side, aft, fore = rng.uniform(0.0, 0.3) * width, *(rng.uniform(0.0, 0.022, 2) * length)
        m.block("hull", (x, end), (-width, width), (top, top + high), aft=aft, fore=fore, side=side)
        if rng.random() < 0.6:
            _mast(m, rng, (0.5 * (x + end), top + high), length)
        if rng.random() < 0.5:
            second = high + rng.uniform(0.3, 0.9) * high
            m.block(
                "hull",
                (x + 0.3 * (end - x), end - 0.1 * long),
                (-0.6 * width, 0.6 * width),
                (top + high, top + second),
                aft=aft,
                fore=fore,
                side=side,
            )
            m.block(
                "dark",
                (end - 0.12 * long, end - 0.08 * long),
                (-0.5 * width, 0.5 * width),
                (top + high + 0.4 * (second - high), top + high + 0.7 * (second - high)),
            )
        x = end + rng.uniform(0.0, 0.12) * length
    for at in rng.uniform(0.74, 0.88, int(rng.integers(0, 3))) * length:
        size = 0.014 * length
        m.block(
            "hull", (at - size, at + size), (-size, size), (top, top + 1.6 * size), side=0.3 * size, fore=0.3 * size
        )
        m.rod("hull", (at, 0.0, top + size), (at + 4.0 * size, 0.0, top + rng.uniform(1.0, 2.0) * size), 0.12 * size)
    return m.surface()


def small_craft(rng: np.random.Generator) -> Surface:
    """A boat of 8 to 45 m with a deckhouse somewhere and a mast; every third has nets or cranes aft."""
    m, length, half, top = _hull(rng, (8.0, 45.0), rng.uniform(0.06, 0.11))
    deck = 0.08 * length
    aft = rng.uniform(0.1, 0.5)
    x = (aft * length, (aft + rng.uniform(0.2, 0.4)) * length)
    height = rng.uniform(0.8, 2.2) * deck
    slope = 0.04 * length
    m.block("white", x, (-0.7 * half, 0.7 * half), (top, top + height), fore=slope)
    m.block(
        "dark",
        (x[0] + 0.5 * (x[1] - x[0]), x[1] + 0.01),
        (-0.71 * half, 0.71 * half),
        (top + 0.5 * height, top + 0.8 * height),
        fore=0.7 * slope,
    )
    _mast(m, rng, (0.5 * (x[0] + x[1]), top + height), 2.0 * length)
    if rng.random() < 0.33:
        for y in (-0.7 * half, 0.7 * half):
            m.rod("white", (0.08 * length, y, top), (0.03 * length, 0.6 * y, top + 2.5 * deck), 0.012 * length)
        m.rod(
            "white",
            (0.03 * length, -0.5 * half, top + 2.5 * deck),
            (0.03 * length, 0.5 * half, top + 2.5 * deck),
            0.012 * length,
        )
    return m.surface()


def sailing_boat(rng: np.random.Generator) -> Surface:
    """One tall mast, a main sail and a fore sail."""
    m, length, half, top = _hull(rng, (7.0, 30.0), 0.07)
    mast, tip = rng.uniform(0.5, 0.62) * length, rng.uniform(1.0, 1.5) * length
    m.block("white", (0.3 * length, 0.6 * length), (-0.5 * half, 0.5 * half), (top, 1.6 * top), fore=0.1 * length)
    m.rod("dark", (mast, 0.0, top), (mast, 0.0, tip), 0.008 * length)
    swing = rng.uniform(-0.3, 0.3) * length
    foot = 1.6 * top + 0.05 * length
    for ends in (
        [(mast, 0.0, foot), (0.08 * length, swing, foot)],
        [(0.97 * length, 0.0, foot), (mast - 0.02 * length, 0.4 * swing, foot)],
    ):
        for corners in ([*ends, (mast, 0.0, 0.95 * tip)], [ends[1], ends[0], (mast, 0.0, 0.95 * tip)]):
            m.patch("white", corners)
    return m.surface()


KINDS: tuple[tuple[Callable[[np.random.Generator], Surface], float], ...] = (
    (warship, 0.34),
    (container_ship, 0.14),
    (tanker, 0.13),
    (ferry, 0.13),
    (small_craft, 0.18),
    (sailing_boat, 0.08),
)
"""Each with its share."""


def _hull(
    rng: np.random.Generator,
    lengths: tuple[float, float],
    freeboard: float,
    more: list[Material] | None = None,
    *,
    grey: bool = False,
) -> tuple[Modeller, float, float, float]:
    """A hull in one colour, raised at the bow or not; modeller, length, half the beam, height of the deck [m]."""
    level = rng.uniform(0.12, 0.5) if grey else rng.uniform(0.02, 0.5)
    colour = level * (np.array([0.95, 1.0, 1.05]) if grey else rng.uniform(0.4, 1.0, 3))
    hull = Material(name="hull", colour=tuple(colour.tolist()))
    m = Modeller([hull, _WHITE, _DARK, *(more or [])])
    length = rng.uniform(*lengths)
    half = 0.5 * length * rng.uniform(0.11, 0.17) * (60.0 / max(length, 60.0)) ** 0.15
    top = freeboard * length
    flare, chamfer = rng.uniform(0.01, 0.05) * length, rng.uniform(0.6, 0.95) * half
    m.block("hull", (0.0, length), (-half, half), (-0.04 * length, top), fore=-flare, chamfer=chamfer)
    if rng.random() < 0.6:
        raised = rng.uniform(0.7, 0.85) * length
        fore = length + flare * top / (top + 0.04 * length)
        m.block(
            "hull",
            (raised, fore),
            (-0.98 * half, 0.98 * half),
            (top, top + rng.uniform(0.01, 0.03) * length),
            fore=-flare,
            chamfer=chamfer,
        )
    return m, length, half, top


def _mast(m: Modeller, rng: np.random.Generator, foot: tuple[float, float], length: float) -> None:
    """A pole with up to three yards."""
    x, z = foot
    tall, thick = rng.uniform(0.04, 0.13) * length, rng.uniform(0.002, 0.006) * length
    name = str(rng.choice(["hull", "white", "dark"]))
    m.rod(name, (x, 0.0, z), (x - rng.uniform(-0.1, 0.2) * tall, 0.0, z + tall), thick, 0.4 * thick)
    for share in rng.uniform(0.4, 0.95, int(rng.integers(0, 4))):
        arm = rng.uniform(0.1, 0.35) * tall
        m.rod(name, (x, -arm, z + share * tall), (x, arm, z + share * tall), 0.4 * thick, sides=6)
    if rng.random() < 0.4:
        m.ball("white", (x, 0.0, z + rng.uniform(0.3, 0.9) * tall), rng.uniform(0.05, 0.15) * tall)


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
