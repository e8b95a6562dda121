# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What a person has said: landmarks on the target, marks in the frames. Immutable; a change makes a new state."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isfinite
from typing import Literal, get_args

import numpy as np

from fairlead.types import Points3, Vector3

Origin = Literal["click", "flow"]
"""Whether a person put the mark there, or optical flow carried it from another frame."""

DEFAULT_SIGMA_PX = 1.0
"""Of a click, one standard deviation [px]: what a careful person reaches at twofold zoom."""
MAX_NAME = 64
Triple = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True, slots=True)
class Landmark:
    """A named point of the target. Marks refer to it by its number, so that a new name loses nothing."""

    number: int
    name: str
    position_m: Triple
    sigma_m: Triple
    """One standard deviation of each coordinate [m]; 0: exact."""

    def __post_init__(self) -> None:
        if not 0 < len(self.name) <= MAX_NAME or not self.name.isprintable() or self.name != self.name.strip():
            raise ValueError(f"landmark name: expected 1 to {MAX_NAME} printable characters, got {self.name!r}")
        if not all(isfinite(value) for value in self.position_m):
            raise ValueError(f"landmark {self.name}: expected finite coordinates, got {self.position_m}")
        if not all(isfinite(value) and value >= 0.0 for value in self.sigma_m):
            raise ValueError(f"landmark {self.name}: expected sigmas >= 0, got {self.sigma_m}")


@dataclass(frozen=True, kw_only=True, slots=True)
class Mark:
    """Where a landmark is seen in a frame, or that it cannot be seen there."""

    u_px: float = float("nan")
    v_px: float = float("nan")
    sigma_px: float = DEFAULT_SIGMA_PX
    hidden: bool = False
    origin: Origin = "click"

    def __post_init__(self) -> None:
        if not self.hidden and not (isfinite(self.u_px) and isfinite(self.v_px)):
            raise ValueError(f"mark: expected finite pixels, got {self.u_px}, {self.v_px}")
        if not (isfinite(self.sigma_px) and self.sigma_px > 0.0):
            raise ValueError(f"mark: expected a sigma above 0 px, got {self.sigma_px}")
        if self.origin not in get_args(Origin):
            raise ValueError(f"mark: expected origin {' or '.join(get_args(Origin))}, got {self.origin!r}")


Marks = Mapping[int, Mark]
"""Of one frame, by number of the landmark."""


@dataclass(frozen=True, kw_only=True)
class Labels:
    """All of it."""

    landmarks: tuple[Landmark, ...] = ()
    frames: Mapping[int, Marks] = field(default_factory=dict[int, Marks])
    """By number of the frame; a frame without marks is missing."""

    def __post_init__(self) -> None:
        names = [landmark.name for landmark in self.landmarks]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise ValueError(f"landmark name: expected different names, got {twice!r} more than once")

    def landmark(self, number: int) -> Landmark:
        """By its number. Raises KeyError."""
        for landmark in self.landmarks:
            if landmark.number == number:
                return landmark
        raise KeyError(number)

    def marks(self, frame: int) -> Marks:
        """Of a frame, of landmarks that there are."""
        known = {landmark.number for landmark in self.landmarks}
        return {number: mark for number, mark in self.frames.get(frame, {}).items() if number in known}

    @property
    def positions(self) -> Points3:
        """(n, 3) [m], in order."""
        return np.array([landmark.position_m for landmark in self.landmarks], dtype=np.float64).reshape(-1, 3)

    @property
    def sigmas(self) -> Points3:
        """(n, 3) [m], in order."""
        return np.array([landmark.sigma_m for landmark in self.landmarks], dtype=np.float64).reshape(-1, 3)


def triple(values: Vector3 | tuple[float, ...] | list[float]) -> Triple:
    """Three floats."""
    x, y, z = (float(value) for value in values)
    return x, y, z
