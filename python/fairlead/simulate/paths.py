# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Where the camera flies: arc, orbit, rendezvous, landing approach, helix. World axes, docs/simulate.md eq. (9)-(14).

The world is the target frame of a target at rest: x forward, y to port, z up. Each path is a function of time; the
camera is upright and looks at one point of the world.
"""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from fairlead.simulate.limits import expect, expect_at_least_zero, expect_positive
from fairlead.simulate.rotations import Times
from fairlead.simulate.trajectory import arc_centres
from fairlead.types import Points3, Vector3

STANDARD_GRAVITY_M_S2 = 9.80665


@runtime_checkable
class Path(Protocol):
    """A curve in the world."""

    @property
    def length_s(self) -> float:
        """How long the flight takes [s]."""
        ...

    def centres(self, t_s: Times) -> Points3:
        """The camera's centre of projection at these instants, (k, 3) [m]."""
        ...


def direction(azimuth_deg: float, elevation_deg: float) -> Vector3:
    """(cos e cos a, cos e sin a, sin e): from the target's origin; azimuth 180 is dead astern."""
    return arc_centres(np.radians(np.array([azimuth_deg])), 1.0, float(np.radians(elevation_deg)))[0]


def _expect_elevation(field: str, value: float) -> None:
    expect(field, value, "an angle between -90 and 90, both excluded", when=-90.0 < value < 90.0)


def eased(u: Times) -> Times:
    """The ramp 3 u^2 - 2 u^3 from 0 to 1, level at both ends and beyond them."""
    u = np.clip(u, 0.0, 1.0)
    return u * u * (3.0 - 2.0 * u)


def eased_integral(u: Times) -> Times:
    """Its integral from 0, u^3 - u^4 / 2 on 0..1; it grows by 1 per unit beyond."""
    inside = np.clip(u, 0.0, 1.0)
    return inside**3 - 0.5 * inside**4 + np.maximum(u - 1.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class _Timed:
    duration_s: float = 30.0
    """Of the flight [s]."""

    def __post_init__(self) -> None:
        expect_positive("duration_s", self.duration_s)

    @property
    def length_s(self) -> float:
        """How long the flight takes [s]."""
        return self.duration_s


@dataclass(frozen=True, kw_only=True)
class Arc(_Timed):
    """Part of a circle about the vertical through the target's origin at constant speed, eq. (9)."""

    angle_deg: float = 90.0
    """What the arc covers; negative the other way round [deg]."""
    range_m: float = 1000.0
    """From the target's origin [m]."""
    elevation_deg: float = 15.0
    """Of the camera above the water, seen from the origin [deg]."""
    azimuth_deg: float = 180.0
    """Of the middle of the arc; 180 is dead astern [deg]."""

    def __post_init__(self) -> None:
        super().__post_init__()
        expect_positive("range_m", self.range_m)
        _expect_elevation("elevation_deg", self.elevation_deg)

    def centres(self, t_s: Times) -> Points3:
        """Eq. (9), (k, 3) [m]."""
        azimuths = np.radians(self.azimuth_deg + self.angle_deg * (t_s / self.duration_s - 0.5))
        return arc_centres(azimuths, self.range_m, float(np.radians(self.elevation_deg)))


@dataclass(frozen=True, kw_only=True)
class Orbit(_Timed):
    """Circles about the vertical through the target's origin at constant speed, eq. (10)."""

    range_m: float = 2000.0
    """From the target's origin [m]."""
    elevation_deg: float = 15.0
    """Of the camera above the water, seen from the origin [deg]."""
    start_azimuth_deg: float = 180.0
    """Where it begins; 180 is dead astern [deg]."""
    speed_m_s: float = 52.0
    """Clockwise seen from above, so from astern to port first; negative the other way [m/s]."""

    def __post_init__(self) -> None:
        super().__post_init__()
        expect_positive("range_m", self.range_m)
        _expect_elevation("elevation_deg", self.elevation_deg)

    def centres(self, t_s: Times) -> Points3:
        """Eq. (10), (k, 3) [m]."""
        elevation = float(np.radians(self.elevation_deg))
        rate = self.speed_m_s / (self.range_m * np.cos(elevation))
        return arc_centres(np.radians(self.start_azimuth_deg) - rate * t_s, self.range_m, elevation)


@dataclass(frozen=True, kw_only=True)
class Rendezvous(_Timed):
    """Straight and at constant speed: the range closes, the bearing changes by the rendezvous angle; eq. (11)."""

    angle_deg: float = 20.0
    """Between the bearings of start and end, seen from the target's origin [deg]."""
    start_range_m: float = 2000.0
    """From the target's origin at the start [m]."""
    end_range_m: float = 500.0
    """And at the end [m]."""
    elevation_deg: float = 15.0
    """Of both ends [deg]."""
    azimuth_deg: float = 180.0
    """Half way between the bearings of the ends; 180 is dead astern [deg]."""

    def __post_init__(self) -> None:
        super().__post_init__()
        expect_positive("start_range_m", self.start_range_m)
        expect_positive("end_range_m", self.end_range_m)
        _expect_elevation("elevation_deg", self.elevation_deg)

    def centres(self, t_s: Times) -> Points3:
        """Eq. (11), (k, 3) [m]."""
        start = self.start_range_m * direction(self.azimuth_deg - 0.5 * self.angle_deg, self.elevation_deg)
        end = self.end_range_m * direction(self.azimuth_deg + 0.5 * self.angle_deg, self.elevation_deg)
        return start + (t_s / self.duration_s)[:, None] * (end - start)


@dataclass(frozen=True, kw_only=True)
class Approach:
    """Down a straight glide path at constant speed, slowing down to a hover at its end, eq. (12)."""

    hover_m: tuple[float, float, float] = (-15.0, 0.0, 20.0)
    """Where it comes to rest, world axes [m]."""
    distance_m: float = 600.0
    """Length of the glide path [m]."""
    slope_deg: float = 6.0
    """Of the glide path against the horizon [deg]."""
    azimuth_deg: float = 180.0
    """Where it comes from, seen from the hover; 180 is from astern [deg]."""
    speed_m_s: float = 25.0
    """On the glide path [m/s]."""
    deceleration_m_s2: float = 1.5
    """The largest; it grows and falls gradually [m/s^2]."""
    hover_s: float = 10.0
    """At rest at the end [s]."""

    def __post_init__(self) -> None:
        for field in ("distance_m", "speed_m_s", "deceleration_m_s2"):
            expect_positive(field, getattr(self, field))
        expect_at_least_zero("hover_s", self.hover_s)
        _expect_elevation("slope_deg", self.slope_deg)
        room = self.braking_s * self.speed_m_s / 2.0
        text = f"at least the {room:.4g} m that it takes to stop"
        expect("distance_m", self.distance_m, text, when=self.distance_m >= room)

    @property
    def braking_s(self) -> float:
        """From the first deceleration to rest [s]."""
        return 1.5 * self.speed_m_s / self.deceleration_m_s2

    @property
    def cruise_s(self) -> float:
        """At constant speed [s]."""
        return self.distance_m / self.speed_m_s - 0.5 * self.braking_s

    @property
    def length_s(self) -> float:
        """How long the flight takes [s]."""
        return self.cruise_s + self.braking_s + self.hover_s

    def centres(self, t_s: Times) -> Points3:
        """Eq. (12), (k, 3) [m]."""
        braking = eased_integral((t_s - self.cruise_s) / self.braking_s)
        flown = self.speed_m_s * (t_s - self.braking_s * braking)
        left = np.where(t_s >= self.cruise_s + self.braking_s, 0.0, self.distance_m - flown)
        return np.array(self.hover_m) + left[:, None] * direction(self.azimuth_deg, self.slope_deg)


@dataclass(frozen=True, kw_only=True)
class Helix(_Timed):
    """Round the vertical through the target's origin while the height changes at a constant rate, eq. (13)."""

    radius_m: float = 500.0
    """Level distance from the axis [m]."""
    start_height_m: float = 50.0
    """At the start [m]."""
    end_height_m: float = 300.0
    """At the end [m]."""
    turns: float = 1.0
    """Counter-clockwise seen from above; negative the other way [-]."""
    start_azimuth_deg: float = 180.0
    """Where it begins; 180 is dead astern [deg]."""

    def __post_init__(self) -> None:
        super().__post_init__()
        expect_positive("radius_m", self.radius_m)

    def centres(self, t_s: Times) -> Points3:
        """Eq. (13), (k, 3) [m]."""
        share = t_s / self.duration_s
        azimuths = np.radians(self.start_azimuth_deg) + 2.0 * np.pi * self.turns * share
        height = self.start_height_m + share * (self.end_height_m - self.start_height_m)
        return np.column_stack([self.radius_m * np.cos(azimuths), self.radius_m * np.sin(azimuths), height])
