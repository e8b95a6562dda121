# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""`fairlead demo`: what the program does, on recordings that come along."""

from fairlead.demo.pen import PenResult, demo_pen, tag_side
from fairlead.demo.ship import SHOWN, ShipResult, demo_ship
from fairlead.demo.show import show_demo

__all__ = ["SHOWN", "PenResult", "ShipResult", "demo_pen", "demo_ship", "show_demo", "tag_side"]
