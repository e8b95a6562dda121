# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The parametric frigate of data/frigate: its surface holds the landmarks of that folder's target.toml.

x forward from the stern, y to port, z up from the waterline [m]; 140 x 18 x 32 m above the water.
"""

import numpy as np

from fairlead.render.frigate.fittings import add_boats, add_clutter, add_foredeck, add_rails
from fairlead.render.frigate.hull import add_hull
from fairlead.render.frigate.markings import add_flight_deck, add_number
from fairlead.render.frigate.superstructure import add_bridge, add_hangar, add_main_mast, add_midships
from fairlead.render.modelling import Modeller
from fairlead.render.surface import Material, Surface

MATERIALS = (
    Material(name="hull", colour=(0.29, 0.32, 0.35)),
    Material(name="super", colour=(0.36, 0.39, 0.42)),
    Material(name="deck", colour=(0.10, 0.11, 0.12), roughness=0.8),
    Material(name="roof", colour=(0.15, 0.16, 0.17), roughness=0.8),
    Material(name="flight", colour=(0.07, 0.075, 0.08), roughness=0.9),
    Material(name="antifouling", colour=(0.22, 0.035, 0.025), roughness=0.6),
    Material(name="boot", colour=(0.012, 0.012, 0.013), roughness=0.5),
    Material(name="line", colour=(0.74, 0.75, 0.73), roughness=0.7),
    Material(name="white", colour=(0.62, 0.63, 0.62), roughness=0.4),
    Material(name="black", colour=(0.022, 0.022, 0.022), roughness=0.5),
    Material(name="soot", colour=(0.03, 0.028, 0.026), roughness=0.9),
    Material(name="window", colour=(0.012, 0.016, 0.02), roughness=0.1),
    Material(name="door", colour=(0.26, 0.28, 0.30)),
    Material(name="panel", colour=(0.20, 0.21, 0.23)),
    Material(name="orange", colour=(0.55, 0.10, 0.02)),
)


def build_frigate(number: str = "F217", seed: int = 0) -> Surface:
    """The whole ship. `number` is painted on it, `seed` places the small things on deck."""
    modeller = Modeller(MATERIALS)
    add_hull(modeller)
    for add in (
        add_bridge,
        add_main_mast,
        add_midships,
        add_hangar,
        add_foredeck,
        add_boats,
        add_rails,
        add_flight_deck,
    ):
        add(modeller)
    add_number(modeller, number)
    add_clutter(modeller, np.random.default_rng(seed))
    return modeller.surface()
