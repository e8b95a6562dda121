# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The hull: stem, sheer, flare, transom and the deck that closes it. x from the stern, z from the waterline [m]."""

import numpy as np

from fairlead.render.modelling import Modeller

HALF_BEAM = 8.284
DRAUGHT = 5.5
DECK = 6.2
"""Height of the flat deck aft [m]."""
BULWARK = 0.9
"""What the plating rises above the deck at the bow [m]."""
BULWARK_START, BULWARK_FULL = 0.82, 0.87
"""Share of the length where the bulwark begins and where it has its full height."""

_BELOW = np.array([-5.4, -5.2, -4.8, -4.0, -3.0, -2.0, -1.0, -0.25])
BOOT_TOP = 0.55
"""Upper edge of the black stripe on the waterline [m]."""


def deck_height(u: np.ndarray) -> np.ndarray:
    """Sheer: flat to midships, then rising by 4.2 m to the bow. `u` is the share of the length, 0 aft."""
    return np.asarray(DECK + 4.2 * np.clip((u - 0.5) / 0.5, 0.0, 1.0) ** 2)


def rail_height(u: np.ndarray) -> np.ndarray:
    """Upper edge of the plating [m]."""
    rise = np.clip((u - BULWARK_START) / (BULWARK_FULL - BULWARK_START), 0.0, 1.0)
    return np.asarray(deck_height(u) + BULWARK * rise)


def stem(z: np.ndarray) -> np.ndarray:
    """x of the stem at a height, through the landmark `bow`: raked above the water, nearly upright below."""
    return np.asarray(140.0 - 0.9384 * (11.3 - np.clip(z, 0.0, None)) + 0.25 * np.clip(z, -9.0, 0.0))


def transom(z: np.ndarray) -> np.ndarray:
    """x of the stern at a height: through `stern_p` and `stern_s`, cut away below the water."""
    return np.asarray(0.73 / DECK * np.clip(z, 0.0, 9.0) + 2.0 * np.clip(-z, 0.0, 9.0))


def half_breadth(u: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Half the breadth [m]: full amidships, fine forward, with flare between waterline and deck."""
    up, down = np.clip(z / deck_height(u), 0.0, 1.05), np.clip(-z / DRAUGHT, 0.0, 1.0)
    fore = np.clip((u - 0.5) / 0.5, 0.0, 1.0)
    entry = np.clip((u - 0.45) / 0.55, 0.0, 1.0)
    run = np.clip((0.45 - u) / 0.45, 0.0, 1.0)
    at_deck = np.where(u > 0.5, 1.0 - fore**2.6, 1.0 - 0.12 * np.clip((0.5 - u) / 0.5, 0.0, 1.0) ** 2)
    at_water = 0.93 * np.where(u > 0.45, 1.0 - entry**1.55, 1.0 - 0.22 * run**2)
    keel = np.where(u > 0.45, 1.0 - entry**1.1, 1.0 - 0.75 * run**1.5)
    above = at_water + (at_deck - at_water) * up**0.8
    below = at_water * np.sqrt(np.clip(1.0 - (0.98 * down) ** 3.2, 0.0, 1.0)) * keel**down
    return np.asarray(HALF_BEAM * np.where(z >= 0.0, above, below))


def hull_point(u: np.ndarray | float, z: np.ndarray | float, side: int, offset: float = 0.0) -> np.ndarray:
    """Points (..., 3) of the plating, `offset` outboard [m]; side +1 is port."""
    u, z = np.broadcast_arrays(np.asarray(u, dtype=np.float64), np.asarray(z, dtype=np.float64))
    x = transom(z) + u * (stem(z) - transom(z))
    return np.stack([x, side * (half_breadth(u, z) + offset), z], axis=-1)


def station(x: float, z: float) -> float:
    """The share of the length at which the plating has this x at this height."""
    height = np.asarray(z)
    return float((x - transom(height)) / (stem(height) - transom(height)))


def add_hull(modeller: Modeller) -> None:
    """Plating, boot top, antifouling, transom and deck."""
    stations = np.unique(np.concatenate([np.linspace(0.0, 0.6, 31), np.linspace(0.6, 1.0, 41), [BULWARK_FULL]]))
    above = np.linspace(0.0, 1.0, 11)
    heights = np.stack([_heights(u, above) for u in stations])
    bands = len(_BELOW) - 1
    for side in (1, -1):
        skin = hull_point(stations[:, None], heights, side)[::-side]
        modeller.sheet("antifouling", skin[:, : bands + 1].swapaxes(0, 1))
        modeller.sheet("boot", skin[:, bands : bands + 2].swapaxes(0, 1))
        modeller.sheet("hull", skin[:, bands + 1 :].swapaxes(0, 1))
    aft = _heights(0.0, above)
    ends = np.stack([hull_point(0.0, aft, 1), hull_point(0.0, aft, -1)], axis=1)
    modeller.sheet("antifouling", ends[: bands + 1])
    modeller.sheet("boot", ends[bands : bands + 2])
    modeller.sheet("hull", ends[bands + 1 :])
    deck = deck_height(stations)
    modeller.sheet("deck", np.stack([hull_point(stations, deck, -1), hull_point(stations, deck, 1)]))


def _heights(u: np.ndarray | float, above: np.ndarray) -> np.ndarray:
    """Heights of the hull's lines at one station."""
    top = float(rail_height(np.asarray(u)))
    return np.concatenate([_BELOW, BOOT_TOP + above * (top - BOOT_TOP)])
