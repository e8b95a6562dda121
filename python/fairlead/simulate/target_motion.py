# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A target that moves: heave, roll, pitch and the other three, about a named point. docs/simulate.md eq. (5)-(8)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fairlead.simulate.limits import expect, expect_at_least_zero, expect_interval
from fairlead.simulate.rotations import Times, turned_about, yaw_pitch_roll
from fairlead.simulate.sines import NOTHING, Sines, draw_sines
from fairlead.simulate.streams import Streams
from fairlead.simulate.trajectory import box_centre
from fairlead.types import Poses, Target, Vector3

AXES = ("roll", "pitch", "yaw", "surge", "sway", "heave")


@dataclass(frozen=True, kw_only=True)
class _Oscillation:
    period_s: float | tuple[float, float] = (8.0, 10.0)
    """One, or the shortest and the longest: frequencies are uniform between theirs [s]."""
    waves: int = 1
    """Number of sines in the sum."""
    phase_deg: float | None = None
    """Phase of all waves at the start; drawn for each if not given [deg]."""

    def __post_init__(self) -> None:
        expect_interval("period_s", self.periods_s)
        expect("waves", self.waves, "1 to 1000", when=1 <= self.waves <= 1000)

    @property
    def periods_s(self) -> tuple[float, float]:
        """Shortest and longest."""
        return self.period_s if isinstance(self.period_s, tuple) else (self.period_s, self.period_s)

    def sines(self, amplitude: float, rng: np.random.Generator) -> Sines:
        """With one wave the amplitude is the largest value; with more the mean square stays that of one wave."""
        band_hz = (1.0 / self.periods_s[1], 1.0 / self.periods_s[0])
        phase_rad = None if self.phase_deg is None else float(np.radians(self.phase_deg))
        return draw_sines(amplitude / np.sqrt(2.0), band_hz, self.waves, rng, phase_rad)


@dataclass(frozen=True, kw_only=True)
class Turning(_Oscillation):
    """A rotation that goes to and fro."""

    amplitude_deg: float = 3.0
    """Of one wave; of several, that of one wave with the same mean square [deg]."""

    def __post_init__(self) -> None:
        super().__post_init__()
        expect_at_least_zero("amplitude_deg", self.amplitude_deg)

    def draw(self, rng: np.random.Generator) -> Sines:
        """The angle over time [rad]."""
        return self.sines(float(np.radians(self.amplitude_deg)), rng)


@dataclass(frozen=True, kw_only=True)
class Shifting(_Oscillation):
    """A displacement that goes to and fro."""

    amplitude_m: float = 1.0
    """Of one wave; of several, that of one wave with the same mean square [m]."""

    def __post_init__(self) -> None:
        super().__post_init__()
        expect_at_least_zero("amplitude_m", self.amplitude_m)

    def draw(self, rng: np.random.Generator) -> Sines:
        """The displacement over time [m]."""
        return self.sines(self.amplitude_m, rng)


@dataclass(frozen=True, kw_only=True)
class TargetMotion:
    """How the target moves in the world; at rest both frames are one."""

    about: str | None = None
    """The landmark that it turns about."""
    about_m: tuple[float, float, float] | None = None
    """The point that it turns about; the middle of the landmarks' box if neither is given [m]."""
    roll: Turning | None = None
    """About the target's x axis."""
    pitch: Turning | None = None
    """About the target's y axis."""
    yaw: Turning | None = None
    """About the world's z axis."""
    surge: Shifting | None = None
    """Along the world's x axis."""
    sway: Shifting | None = None
    """Along the world's y axis."""
    heave: Shifting | None = None
    """Along the world's z axis."""

    def __post_init__(self) -> None:
        both = self.about is not None and self.about_m is not None
        expect("about", self.about, "about or about_m, not both", when=not both)

    @property
    def moves(self) -> bool:
        """Whether there is any motion at all."""
        return any(getattr(self, axis) is not None for axis in AXES)

    def point(self, target: Target) -> Vector3:
        """What the target turns about, target axes [m]. Raises ValueError for a landmark that is not there."""
        return chosen_point(target, self.about, self.about_m, "about")

    def draw(self, target: Target, streams: Streams) -> Callable[[Times], Poses]:
        """T_world_target as a function of time, eq. (7); each axis has a stream of its own."""
        point = self.point(target)
        drawn: dict[str, Sines] = {}
        for index, axis in enumerate(AXES):
            part: Turning | Shifting | None = getattr(self, axis)
            drawn[axis] = NOTHING if part is None else part.draw(streams.of("target_motion", index))

        def T_world_target(t_s: Times) -> Poses:
            angles = [drawn[axis](t_s) for axis in ("yaw", "pitch", "roll")]
            shift = np.column_stack([drawn[axis](t_s) for axis in ("surge", "sway", "heave")])
            return turned_about(yaw_pitch_roll(*angles), point, shift)

        return T_world_target


def chosen_point(target: Target, landmark: str | None, point_m: tuple[float, float, float] | None, key: str) -> Vector3:
    """A landmark by name, a point, or else the middle of the box of the landmarks [m]."""
    if landmark is not None:
        if landmark not in target.landmarks:
            raise ValueError(f"{key}: expected a landmark of {target.name}, got {landmark!r}")
        return target.positions[target.landmarks.index(landmark)]
    return box_centre(target.positions) if point_m is None else np.array(point_m, dtype=np.float64)
