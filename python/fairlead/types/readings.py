# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What other sensors say of the same flight: ranges and attitudes of the camera."""

from dataclasses import dataclass

import numpy as np

from fairlead.types.arrays import Matrix3
from fairlead.types.checks import assign, frozen_array, integer, is_rigid, number


@dataclass(frozen=True, kw_only=True)
class RangeReading:
    """Distance from the camera's centre of projection to a point of the target.

    Numbers that are not finite are allowed here: the estimator drops them. Raises ValueError for an empty name.
    """

    stamp_ns: int
    range_m: float
    sigma_m: float
    """One standard deviation [m]."""
    landmark: str | None = None
    """To this landmark; None: to the origin of the target frame."""

    def __post_init__(self) -> None:
        stamp_ns = integer(self.stamp_ns, "range stamp_ns")
        range_m, sigma_m = number(self.range_m, "range range_m"), number(self.sigma_m, "range sigma_m")
        assign(self, stamp_ns=stamp_ns, range_m=range_m, sigma_m=sigma_m)
        if self.landmark is not None and not self.landmark:
            raise ValueError("range landmark: expected a name, or None for the target's origin, got an empty text")


@dataclass(frozen=True, kw_only=True, eq=False)
class AttitudeReading:
    """Attitude of the camera: R_world_camera turns camera axes into world-aligned axes, CONVENTIONS.md section 1.

    The world's z axis points up; where its x axis points is not told, but it stays. The error is a rotation in camera
    axes, the same in every direction: R_read = R_true Exp(e), e ~ N(0, sigma_rad^2 I). Raises ValueError for a matrix
    that is not a rotation.
    """

    stamp_ns: int
    R_world_camera: Matrix3
    sigma_rad: float
    """One standard deviation of each component of the rotation vector e [rad]."""

    def __post_init__(self) -> None:
        R = frozen_array(self.R_world_camera, (3, 3), "attitude R_world_camera")
        T = np.eye(4)
        T[:3, :3] = R
        if not is_rigid(T):
            raise ValueError(f"attitude R_world_camera: expected a rotation, got {R.tolist()}")
        stamp_ns = integer(self.stamp_ns, "attitude stamp_ns")
        assign(self, stamp_ns=stamp_ns, R_world_camera=R, sigma_rad=number(self.sigma_rad, "attitude sigma_rad"))
