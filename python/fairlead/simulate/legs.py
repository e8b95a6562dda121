# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A flight made of legs: straight on, turns at so many g, changes of speed and of climb. docs/simulate.md eq. (14)."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Float64

from fairlead.simulate.limits import expect, expect_at_least_zero, expect_positive
from fairlead.simulate.paths import STANDARD_GRAVITY_M_S2, eased
from fairlead.simulate.rotations import Times
from fairlead.types import Points3

STEP_S = 0.005
"""Of the integration [s]."""
MAX_LENGTH_S = 3600.0
"""Longest flight made of legs [s]."""


@dataclass(frozen=True, kw_only=True)
class Leg:
    """A part of the flight; what is not given stays as it was."""

    duration_s: float
    """Of this leg [s]."""
    turn_g: float = 0.0
    """Acceleration across the track, to port if positive, in units of standard gravity [g]."""
    speed_m_s: float | None = None
    """Level speed that is reached at the end of the leg [m/s]."""
    climb_m_s: float | None = None
    """Rate of climb that is reached at the end of the leg [m/s]."""

    def __post_init__(self) -> None:
        expect_positive("duration_s", self.duration_s)
        if self.speed_m_s is not None:
            expect_at_least_zero("speed_m_s", self.speed_m_s)


@dataclass(frozen=True, kw_only=True)
class Legs:
    """Legs one after another; accelerations grow and fall gradually, so that jerk is finite."""

    start_m: tuple[float, float, float] = (-1000.0, 0.0, 260.0)
    """Where it begins, world axes [m]."""
    heading_deg: float = 0.0
    """Direction of flight at the start: 0 along x, 90 along y [deg]."""
    speed_m_s: float = 50.0
    """Level speed at the start [m/s]."""
    climb_m_s: float = 0.0
    """Rate of climb at the start [m/s]."""
    ease_s: float = 1.0
    """How long a turn takes to build up and to end [s]."""
    leg: tuple[Leg, ...] = (Leg(duration_s=30.0),)
    """In order."""

    def __post_init__(self) -> None:
        expect_at_least_zero("speed_m_s", self.speed_m_s)
        expect_positive("ease_s", self.ease_s)
        expect("leg", len(self.leg), "at least one leg", when=len(self.leg) > 0)
        expect("leg", self.length_s, f"at most {MAX_LENGTH_S:g} s in all", when=self.length_s <= MAX_LENGTH_S)
        speed = self.speed_m_s
        for index, leg in enumerate(self.leg):
            end = speed if leg.speed_m_s is None else leg.speed_m_s
            moving = leg.turn_g == 0.0 or min(speed, end) > 0.0
            expect(f"leg[{index}].turn_g", leg.turn_g, "0 where the speed is 0", when=moving)
            speed = end

    @property
    def length_s(self) -> float:
        """How long the flight takes [s]."""
        return sum(leg.duration_s for leg in self.leg)

    def centres(self, t_s: Times) -> Points3:
        """Between the steps of the integration by cubic Hermite polynomials, (k, 3) [m]."""
        position, velocity = integrated(self)
        last = len(position) - 2
        index = np.clip((t_s / STEP_S).astype(np.int64), 0, last)
        u = (t_s / STEP_S - index)[:, None]
        p, q = position[index], position[index + 1]
        v, w = STEP_S * velocity[index], STEP_S * velocity[index + 1]
        return p + u * v + u**2 * (3.0 * (q - p) - 2.0 * v - w) + u**3 * (2.0 * (p - q) + v + w)


Samples = Float64[np.ndarray, "s"]


@lru_cache(maxsize=32)
def integrated(legs: Legs) -> tuple[Points3, Points3]:
    """Position [m] and velocity [m/s] every STEP_S, from the start to just beyond the end."""
    t = STEP_S * np.arange(int(np.ceil(legs.length_s / STEP_S)) + 2)
    speed, climb, turn = _commands(legs, t)
    rate = np.divide(turn, speed, out=np.zeros(len(t)), where=speed > 0.0)
    heading = np.radians(legs.heading_deg) + _integral(rate)
    velocity = np.column_stack([speed * np.cos(heading), speed * np.sin(heading), climb])
    position = np.column_stack([_integral(column) for column in velocity.T]) + np.array(legs.start_m)
    position.setflags(write=False)
    velocity.setflags(write=False)
    return position, velocity


def _commands(legs: Legs, t: Samples) -> tuple[Samples, Samples, Samples]:
    """Level speed, rate of climb and acceleration across the track over time, eq. (14)."""
    speed, climb, turn = np.full(len(t), legs.speed_m_s), np.full(len(t), legs.climb_m_s), np.zeros(len(t))
    begin, now, rising = 0.0, legs.speed_m_s, legs.climb_m_s
    for leg in legs.leg:
        share = eased((t - begin) / leg.duration_s)
        if leg.speed_m_s is not None:
            speed += (leg.speed_m_s - now) * share
            now = leg.speed_m_s
        if leg.climb_m_s is not None:
            climb += (leg.climb_m_s - rising) * share
            rising = leg.climb_m_s
        ease = min(legs.ease_s, 0.5 * leg.duration_s)
        bump = eased((t - begin) / ease) - eased((t - begin - leg.duration_s) / ease + 1.0)
        turn += leg.turn_g * STANDARD_GRAVITY_M_S2 * bump
        begin += leg.duration_s
    return np.maximum(speed, 0.0), climb, turn


def _integral(values: Samples) -> Samples:
    """By trapezoids from 0."""
    return np.concatenate([[0.0], np.cumsum(0.5 * STEP_S * (values[1:] + values[:-1]))])
