# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A flight that was flown: the poses of a trajectory.tum, between its stamps by a spline. docs/simulate.md eq. (15)."""

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from fairlead.io.errors import InputError
from fairlead.io.tum import read_trajectory_tum
from fairlead.simulate.rotations import Rotations, Times
from fairlead.types import Points3


@dataclass(frozen=True, kw_only=True)
class Recorded:
    """The camera in the frame of the target at rest; its attitude is as recorded, nothing is looked at."""

    file: Path
    """trajectory.tum: stamp [s], position [m], quaternion x y z w of the camera in the target frame."""

    @property
    def length_s(self) -> float:
        """From the first pose to the last [s]."""
        return float(self.stamps_s[-1])

    @property
    def stamps_s(self) -> Times:
        """Since the first pose [s]."""
        return _splines(self.file)[0]

    def centres(self, t_s: Times) -> Points3:
        """By a cubic spline through the recorded positions, (k, 3) [m]."""
        return np.asarray(_splines(self.file)[1](t_s), dtype=np.float64)

    def R_world_camera(self, t_s: Times) -> Rotations:
        """Attitude: along the shortest rotation between neighbours."""
        times, _, slerp = _splines(self.file)
        return np.asarray(slerp(np.clip(t_s, times[0], times[-1])).as_matrix(), dtype=np.float64)


@lru_cache(maxsize=8)
def _splines(file: Path) -> tuple[Times, Any, Any]:
    """Stamps, and what interpolates positions and attitudes. Raises InputError."""
    from scipy.interpolate import CubicSpline
    from scipy.spatial.transform import Rotation, Slerp

    stamps_ns, T_world_camera = read_trajectory_tum(file)
    if len(stamps_ns) < 2:
        raise InputError(file, f"expected at least 2 poses, got {len(stamps_ns)}")
    if np.any(np.diff(stamps_ns) <= 0):
        line = int(np.argmin(np.diff(stamps_ns) > 0)) + 2
        raise InputError(file, f"expected stamps that grow; pose {line} is not after the one before")
    times = (stamps_ns - stamps_ns[0]) / 1e9
    times.setflags(write=False)
    rotations = Rotation.from_matrix(T_world_camera[:, :3, :3])
    return times, CubicSpline(times, T_world_camera[:, :3, 3]), Slerp(times, rotations)
