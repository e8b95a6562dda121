# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""trajectory.tum: the camera in the target frame, `stamp[s] tx ty tz qx qy qz qw` a line, for evo and others."""

from collections.abc import Iterable
from pathlib import Path

from fairlead.geometry import inverse
from fairlead.io.poses import pose_cells
from fairlead.types import Estimate, Matrix4, TruthPose


def tum_line(stamp_ns: int, T_camera_target: Matrix4) -> str:
    """One line: T_target_camera = inv(T_camera_target), the stamp in seconds with nine decimals."""
    sign = "-" if stamp_ns < 0 else ""
    seconds, nanoseconds = divmod(abs(stamp_ns), 10**9)
    cells = " ".join(repr(value) for value in pose_cells(inverse(T_camera_target)))
    return f"{sign}{seconds}.{nanoseconds:09d} {cells}\n"


def write_trajectory_tum(path: Path | str, trajectory: Iterable[Estimate | TruthPose]) -> None:
    """Write a trajectory; estimates without a pose are left out."""
    with Path(path).open("w", encoding="utf-8", newline="\n") as stream:
        for pose in trajectory:
            if isinstance(pose, TruthPose) or pose.ok:
                stream.write(tum_line(pose.stamp_ns, pose.T_camera_target))
