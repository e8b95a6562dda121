# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The settings of each study, and the seed of each run of a setting, docs/study.md section 2."""

import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from fairlead.config import StudyKind
from fairlead.simulate import ArcScenario, ModelError, ObservationError

SIGMAS_PX = (0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 8.0)
"""Figure 7 of the publication."""
ANGLES_DEG = (5.0, 10.0, 20.0, 30.0, 45.0, 60.0, 90.0, 120.0, 180.0)
"""Figure 8."""
GRID_SIGMAS_PX = (0.5, 1.0, 2.0, 4.0, 8.0)
GRID_ANGLES_DEG = (5.0, 30.0, 90.0, 180.0)
GRID_MODEL_SIGMAS_M = (0.3, 1.0, 3.0)
GRID_OUTLIERS = (0.0, 0.1, 0.3)
VIEWS = 10
VIEWS_PER_DEG = 1
"""Of the flight that segments are cut from."""


@dataclass(frozen=True, kw_only=True)
class Setting:
    """What the runs of one setting have in common: an arc at 1 km about the stern, flown once."""

    sigma_px: float = 1.0
    """Noise of the observations [px]."""
    angle_deg: float = 90.0
    """What the arc covers [deg]."""
    model_sigma_m: float = 1.0
    """Error of each coordinate of each told landmark [m]."""
    outlier_fraction: float = 0.0
    """Share of the observations that are 30 px off [-]."""
    views: int = VIEWS

    @property
    def name(self) -> str:
        """Such as s1-a90-m1-o0-v10: the values in order, each after its letter."""
        values = (self.sigma_px, self.angle_deg, self.model_sigma_m, self.outlier_fraction, self.views)
        return "-".join(f"{letter}{value:g}" for letter, value in zip("samov", values, strict=True))

    @property
    def scenario(self) -> ArcScenario:
        """How `fairlead.simulate` draws it."""
        return ArcScenario(
            angle_deg=self.angle_deg,
            views=self.views,
            interval_s=30.0 * self.angle_deg / 90.0 / max(self.views - 1, 1),
            model=ModelError(sigma_m=self.model_sigma_m),
            observation=ObservationError(sigma_px=self.sigma_px, outlier_fraction=self.outlier_fraction),
        )

    def generator(self, seed: int, run: int) -> np.random.Generator:
        """The randomness of one run, which depends on nothing but the study's seed, the setting's name and `run`."""
        key = (zlib.crc32(self.name.encode("ascii")), run)
        return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))


def segment(angle_deg: float) -> Setting:
    """A piece of a flight that takes a picture every degree: the number of views grows with the angle."""
    return Setting(angle_deg=angle_deg, views=round(VIEWS_PER_DEG * angle_deg) + 1)


def settings_of(kind: StudyKind) -> tuple[Setting, ...]:
    """All settings of a study, in order."""
    if kind == "noise":
        return tuple(Setting(sigma_px=sigma) for sigma in SIGMAS_PX)
    if kind == "angle":
        return (*(Setting(angle_deg=angle) for angle in ANGLES_DEG), *(segment(angle) for angle in ANGLES_DEG))
    grid = product(GRID_OUTLIERS, GRID_MODEL_SIGMAS_M, GRID_ANGLES_DEG, GRID_SIGMAS_PX)
    return tuple(
        Setting(sigma_px=sigma, angle_deg=angle, model_sigma_m=model, outlier_fraction=outliers)
        for outliers, model, angle, sigma in grid
    )


def find_setting(settings: Sequence[Setting], name: str) -> Setting:
    """The setting of this name; ValueError names some that there are."""
    for setting in settings:
        if setting.name == name:
            return setting
    known = ", ".join(setting.name for setting in settings[:3])
    raise ValueError(f"expected the name of a setting of this study, such as {known}, got {name!r}")
