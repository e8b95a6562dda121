# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Where the camera looks, and how it shakes. docs/simulate.md eq. (3), (4)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fairlead.simulate.limits import expect, expect_at_least_zero, expect_interval
from fairlead.simulate.rotations import Times, exp_rotations
from fairlead.simulate.sines import Sines, draw_sines
from fairlead.simulate.streams import Effect, Streams
from fairlead.simulate.target_motion import chosen_point
from fairlead.types import Points3, Target, Vector3


@dataclass(frozen=True, kw_only=True)
class Pointing:
    """The point of the world that the camera is kept on, as by a gimbal."""

    at: str | None = None
    """Where this landmark is while the target is at rest."""
    at_m: tuple[float, float, float] | None = None
    """This point; the middle of the landmarks' box if neither is given [m]."""

    def __post_init__(self) -> None:
        expect("at", self.at, "at or at_m, not both", when=self.at is None or self.at_m is None)

    def point(self, target: Target) -> Vector3:
        """World axes [m]. Raises ValueError for a landmark that is not there."""
        return chosen_point(target, self.at, self.at_m, "at")


@dataclass(frozen=True, kw_only=True)
class Shake:
    """What keeps the camera from flying its path and from looking where it should."""

    sigma_deg: float = 0.0
    """Rms rotation about each camera axis [deg]."""
    band_hz: tuple[float, float] = (1.0, 10.0)
    """Lowest and highest frequency of the rotation [Hz]."""
    sway_m: float = 0.0
    """Rms displacement along each world axis [m]."""
    sway_band_hz: tuple[float, float] = (0.05, 0.2)
    """Lowest and highest frequency of the displacement [Hz]."""
    waves: int = 12
    """Number of sines per axis."""

    def __post_init__(self) -> None:
        expect_at_least_zero("sigma_deg", self.sigma_deg)
        expect_at_least_zero("sway_m", self.sway_m)
        expect_interval("band_hz", self.band_hz)
        expect_interval("sway_band_hz", self.sway_band_hz)
        expect("waves", self.waves, "1 to 1000", when=1 <= self.waves <= 1000)

    def turning(self, streams: Streams) -> "Callable[[Times], np.ndarray] | None":
        """Rotation Exp(e(t)) of the camera, (k, 3, 3); None if there is none."""
        if self.sigma_deg == 0.0:
            return None
        axes = self._axes(float(np.radians(self.sigma_deg)), self.band_hz, streams, "shake")
        return lambda t_s: exp_rotations(_columns(axes, t_s))

    def swaying(self, streams: Streams) -> "Callable[[Times], Points3] | None":
        """Displacement of the camera, world axes, (k, 3) [m]; None if there is none."""
        if self.sway_m == 0.0:
            return None
        axes = self._axes(self.sway_m, self.sway_band_hz, streams, "sway")
        return lambda t_s: _columns(axes, t_s)

    def _axes(self, rms: float, band_hz: tuple[float, float], streams: Streams, effect: Effect) -> list[Sines]:
        return [draw_sines(rms, band_hz, self.waves, streams.of(effect, axis)) for axis in range(3)]


def _columns(axes: list[Sines], t_s: Times) -> Points3:
    return np.column_stack([axis(t_s) for axis in axes])
