# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Where the vehicle was and how it was turned when an image was taken, docs/mavlink.md eq. (2)-(4)."""

from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from fairlead.geometry import exp_so3, log_so3
from fairlead.io.mount import Mount
from fairlead.types import Matrix3, Matrix4, Vector3

KEPT = 500
MAX_GAP_NS = 150_000_000
"""Between two messages further apart the state is not known."""
MAX_AHEAD_NS = 60_000_000
"""Nor is it so long after the last one."""

T = TypeVar("T")


class History(Generic[T]):
    """Stamped values, looked up in between. Stamps that do not grow are not taken; a clock set back starts anew."""

    def __init__(self, mix: Callable[[T, T, float], T]) -> None:
        self._mix = mix
        self._stamps: list[int] = []
        self._values: list[T] = []

    def add(self, stamp_ns: int, value: T) -> None:
        """Append."""
        if self._stamps and stamp_ns <= self._stamps[-1]:
            if stamp_ns > self._stamps[-1] - 10**9:
                return
            self._stamps, self._values = [], []  # it was started again
        self._stamps.append(stamp_ns)
        self._values.append(value)
        if len(self._stamps) > 2 * KEPT:
            self._stamps, self._values = self._stamps[-KEPT:], self._values[-KEPT:]

    def at(self, stamp_ns: int) -> T | None:
        """Between the two values around it, or on from the last two; None where that says nothing."""
        after = bisect_right(self._stamps, stamp_ns)
        if after == 0 or len(self._stamps) < 2:
            return None
        after = min(max(after, 1), len(self._stamps) - 1)
        before_ns, after_ns = self._stamps[after - 1], self._stamps[after]
        if after_ns - before_ns > MAX_GAP_NS or stamp_ns - after_ns > MAX_AHEAD_NS:
            return None
        share = (stamp_ns - before_ns) / (after_ns - before_ns)
        return self._mix(self._values[after - 1], self._values[after], share)


def mix_vectors(a: Vector3, b: Vector3, share: float) -> Vector3:
    """On the straight line."""
    return a + share * (b - a)


def mix_rotations(a: Matrix3, b: Matrix3, share: float) -> Matrix3:
    """At a constant rate of turn: R = R_a Exp(share Log(R_a^T R_b))."""
    return a @ exp_so3(share * log_so3(a.T @ b))


@dataclass(frozen=True, kw_only=True, eq=False)
class VehicleState:
    """At one moment; what is not known is None."""

    R_ned_body: Matrix3 | None
    p_ned: Vector3 | None
    """Of the body's origin in the autopilot's local frame [m]."""
    R_ned_gimbal: Matrix3 | None


UNKNOWN = VehicleState(R_ned_body=None, p_ned=None, R_ned_gimbal=None)


class Vehicle:
    """The messages of the autopilot, by its own clock."""

    def __init__(self) -> None:
        self.attitude: History[Matrix3] = History(mix_rotations)
        self.position: History[Vector3] = History(mix_vectors)
        self.gimbal: History[Matrix3] = History(mix_rotations)

    def at(self, stamp_ns: int) -> VehicleState:
        """Everything at one moment of the autopilot's clock."""
        attitude, position, gimbal = (each.at(stamp_ns) for each in (self.attitude, self.position, self.gimbal))
        return VehicleState(R_ned_body=attitude, p_ned=position, R_ned_gimbal=gimbal)


def camera_in_body(mount: Mount, state: VehicleState) -> Matrix4 | None:
    """T_body_camera, eq. (1)-(2); None where a gimbal's attitude is needed and not known."""
    if mount.gimbal is None:
        return mount.T_carrier_camera
    if state.R_ned_gimbal is None or state.R_ned_body is None:
        return None
    T_body_gimbal = np.eye(4)
    T_body_gimbal[:3, :3] = state.R_ned_body.T @ state.R_ned_gimbal
    T_body_gimbal[:3, 3] = mount.gimbal.position
    return T_body_gimbal @ mount.T_carrier_camera
