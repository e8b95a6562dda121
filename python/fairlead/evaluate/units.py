# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Numbers and lengths as people read them in the report; files and Python stay in metres."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from fairlead.evaluate.evaluation import Evaluation

SMALL_TARGET_M = 2.0
"""Targets smaller than this are reported in millimetres [m]."""


@dataclass(frozen=True, kw_only=True)
class LengthUnit:
    """A unit and how many of it make a metre."""

    name: str
    per_metre: float

    def scaled(self, value: float, unit: str) -> float:
        """A value of a metric in this unit if its own is the metre, else as it is."""
        return value * self.per_metre if unit == "m" else value

    def renamed(self, unit: str) -> str:
        """The unit that `scaled` gives."""
        return self.name if unit == "m" else unit


METRE = LengthUnit(name="m", per_metre=1.0)
MILLIMETRE = LengthUnit(name="mm", per_metre=1000.0)


def length_unit(evaluations: Iterable[Evaluation]) -> LengthUnit:
    """Millimetres where the landmarks of every run lie within SMALL_TARGET_M."""
    sizes = [float(np.ptp(each.run.target0.positions, axis=0).max()) for each in evaluations]
    return MILLIMETRE if sizes and max(sizes) < SMALL_TARGET_M else METRE


def number(value: float) -> str:
    """Three significant digits; a dash for NaN."""
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    if value == 0.0:
        return "0"
    magnitude = math.floor(math.log10(abs(value)))
    if magnitude >= 6 or magnitude < -4:
        return f"{value:.2e}".replace("-", "−")
    return f"{value:.{max(0, 2 - magnitude)}f}".replace("-", "−")
