# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""trajectory.tum: the camera in the target frame, `stamp[s] tx ty tz qx qy qz qw` a line, for evo and others."""

from collections.abc import Iterable
from decimal import Decimal
from pathlib import Path

import numpy as np

from fairlead.geometry import inverse, matrix_from_quat_xyzw
from fairlead.io.documents import read_text
from fairlead.io.errors import InputError
from fairlead.io.poses import QUATERNION_TOLERANCE, pose_cells
from fairlead.types import Estimate, Matrix4, Poses, TruthPose

MAX_STAMP_S = 9_000_000_000
"""Stamps beyond do not fit 64 bits of nanoseconds [s]."""


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


def read_trajectory_tum(path: Path | str) -> tuple[np.ndarray, Poses]:
    """Stamps [ns] (k,) and poses T_target_camera (k, 4, 4), in the order of the file; lines with # are comments.

    Raises InputError (file, line) for anything but eight numbers a line, or a quaternion that is not unit.
    """
    path = Path(path)
    stamps: list[int] = []
    poses: list[Matrix4] = []
    for line, text in enumerate(read_text(path).splitlines(), 1):
        cells = text.split()
        if cells and not cells[0].startswith("#"):
            stamp_ns, T = _pose_line(cells, path, line)
            stamps.append(stamp_ns)
            poses.append(T)
    return np.array(stamps, dtype=np.int64), np.array(poses, dtype=np.float64).reshape(-1, 4, 4)


def _pose_line(cells: list[str], path: Path, line: int) -> tuple[int, Matrix4]:
    if len(cells) != 8:
        raise InputError(path, f"expected stamp tx ty tz qx qy qz qw, got {len(cells)} cells", line=line)
    try:
        seconds = Decimal(cells[0])
        numbers = np.array([float(cell) for cell in cells[1:]])
    except (ValueError, ArithmeticError):
        raise InputError(path, f"expected eight numbers, got {' '.join(cells)[:60]!r}", line=line) from None
    if not (np.isfinite(numbers).all() and seconds.is_finite() and abs(seconds) < MAX_STAMP_S):
        raise InputError(path, "expected eight finite numbers", line=line)
    norm = float(np.linalg.norm(numbers[3:]))
    if abs(norm - 1.0) > QUATERNION_TOLERANCE:
        raise InputError(path, f"expected a unit quaternion, got one of norm {norm:.6g}", line=line)
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = matrix_from_quat_xyzw(numbers[3:]), numbers[:3]
    return round(seconds * 10**9), T
