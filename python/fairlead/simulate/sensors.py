# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What other sensors read: ranges, and the attitude of the camera. docs/simulate.md eq. (26), (27)."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from fairlead.simulate.frames import instants, nanoseconds
from fairlead.simulate.limits import expect, expect_at_least_zero, expect_positive, expect_share
from fairlead.simulate.rotations import Rotations, Times, exp_rotations
from fairlead.simulate.streams import Streams
from fairlead.types import AttitudeReading, Points3, RangeReading


def reading_times(rate_hz: float | None, exposed_s: Times, length_s: float) -> Float64[np.ndarray, "readings"]:
    """With each image, lost ones too, or at a rate of its own [s]."""
    return exposed_s if rate_hz is None else instants(rate_hz, length_s)


@dataclass(frozen=True, kw_only=True)
class RangeFinder:
    """Distance from the camera to the target's origin or to a landmark."""

    landmark: str | None = None
    """To this landmark; to the origin of the target frame if not given."""
    rate_hz: float | None = None
    """Readings per second, the first at the start; with each image if not given [1/s]."""
    sigma_m: float = 0.5
    """1 sigma of the noise [m]."""
    told_factor: float = 1.0
    """The sensor tells sigma_m multiplied by this [-]."""
    bias_m: float = 0.0
    """What all readings are too long by [m]."""
    outlier_share: float = 0.0
    """Of the readings [-]."""
    outlier_m: float = 50.0
    """How far an outlier is off, to either side, on top of the noise [m]."""

    def __post_init__(self) -> None:
        if self.rate_hz is not None:
            expect_positive("rate_hz", self.rate_hz)
        expect_positive("sigma_m", self.sigma_m)
        expect_positive("told_factor", self.told_factor)
        expect_share("outlier_share", self.outlier_share)
        expect("bias_m", self.bias_m, "a number", when=bool(np.isfinite(self.bias_m)))
        expect("outlier_m", self.outlier_m, "a number", when=bool(np.isfinite(self.outlier_m)))

    def read(self, t_s: Times, points_camera: Points3, streams: Streams, index: int) -> list[RangeReading]:
        """One reading per instant, eq. (26); `points_camera`: what is measured to, camera axes [m]."""
        noise = self.sigma_m * streams.of("range", index).standard_normal(len(t_s))
        ranges = np.linalg.norm(points_camera, axis=1) + self.bias_m + noise
        if self.outlier_share > 0.0:
            rng = streams.of("range_outliers", index)
            wrong = rng.random(len(t_s)) < self.outlier_share
            ranges += np.where(wrong, self.outlier_m * rng.choice([-1.0, 1.0], len(t_s)), 0.0)
        told = self.told_factor * self.sigma_m
        return [
            RangeReading(stamp_ns=stamp_ns, range_m=range_m, sigma_m=told, landmark=self.landmark)
            for stamp_ns, range_m in zip(nanoseconds(t_s).tolist(), ranges.tolist(), strict=True)
        ]


@dataclass(frozen=True, kw_only=True)
class AttitudeSensor:
    """Attitude of the camera in the world, as an autopilot knows it."""

    rate_hz: float | None = None
    """Readings per second, the first at the start; with each image if not given [1/s]."""
    sigma_deg: float = 0.2
    """1 sigma of the rotation about each camera axis [deg]."""
    told_factor: float = 1.0
    """The sensor tells sigma_deg multiplied by this [-]."""
    bias_deg: float = 0.0
    """1 sigma of a constant rotation about each camera axis, drawn once [deg]."""

    def __post_init__(self) -> None:
        if self.rate_hz is not None:
            expect_positive("rate_hz", self.rate_hz)
        expect_positive("sigma_deg", self.sigma_deg)
        expect_positive("told_factor", self.told_factor)
        expect_at_least_zero("bias_deg", self.bias_deg)

    def read(self, t_s: Times, R_world_camera: Rotations, streams: Streams) -> list[AttitudeReading]:
        """One reading per instant, eq. (27)."""
        rng = streams.of("attitude")
        bias = np.radians(self.bias_deg) * rng.standard_normal(3)
        errors = bias + np.radians(self.sigma_deg) * rng.standard_normal((len(t_s), 3))
        told = self.told_factor * float(np.radians(self.sigma_deg))
        return [
            AttitudeReading(stamp_ns=stamp_ns, R_world_camera=R, sigma_rad=told)
            for stamp_ns, R in zip(nanoseconds(t_s).tolist(), R_world_camera @ exp_rotations(errors), strict=True)
        ]
