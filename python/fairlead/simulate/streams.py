# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Randomness: one stream per effect, so that switching one effect on leaves the draws of all others as they were."""

import zlib
from collections.abc import Sequence
from typing import Literal

import numpy as np

Seed = int | Sequence[int]
"""A whole number >= 0, or several: a study may give (seed, setting, run)."""

Effect = Literal[
    "model",
    "distances",
    "target_motion",
    "shake",
    "sway",
    "jitter",
    "stamps",
    "drops",
    "noise",
    "tail",
    "bias_px",
    "bias_m",
    "outliers",
    "outlier_offsets",
    "swaps",
    "dropout",
    "bursts",
    "range",
    "range_outliers",
    "attitude",
]


class Streams:
    """A generator per effect, keyed by its name, so that later effects do not move it; docs/simulate.md eq. (1)."""

    def __init__(self, seed: Seed) -> None:
        numbers = [seed] if isinstance(seed, int) else list(seed)
        if not numbers or min(numbers) < 0:
            raise ValueError(f"seed: expected whole numbers >= 0, got {seed}")
        self._entropy = numbers

    def of(self, effect: Effect, index: int = 0) -> np.random.Generator:
        """A fresh generator at the start of the stream of this effect; `index` counts sensors of one kind."""
        key = (zlib.crc32(effect.encode("ascii")), index)
        return np.random.default_rng(np.random.SeedSequence(self._entropy, spawn_key=key))
