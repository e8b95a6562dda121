# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""poses.csv <-> Estimates, truth.csv <-> TruthPoses, docs/files.md."""

import math
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import cast, get_args

import numpy as np

from fairlead.geometry import matrix_from_quat_xyzw, quat_xyzw_from_matrix
from fairlead.io.csv_lines import CsvWriter, integer_cell, number_cell, read_csv, without_torn_end
from fairlead.io.errors import InputError
from fairlead.types import Estimate, Matrix4, Matrix6, Status, TruthPose

POSE_COLUMNS = ("tx", "ty", "tz", "qx", "qy", "qz", "qw")
TRUTH_COLUMNS = ("frame", "stamp_ns", *POSE_COLUMNS)
COVARIANCE_COLUMNS = tuple(f"c{i}{j}" for i in range(6) for j in range(i, 6))
COLUMNS = (*TRUTH_COLUMNS, "status", "reason", *COVARIANCE_COLUMNS, "n_inliers", "reprojection_rms_px")

_UPPER = np.triu_indices(6)

QUATERNION_TOLERANCE = 1e-3
"""Largest deviation of a quaternion's norm from 1: enough for three decimals, too little for a torn line [-]."""


def read_poses(path: Path | str) -> list[Estimate]:
    """Read poses.csv.

    `information_gained` is not in the file and comes back NaN, `reset_counter` 0, `inliers` empty. A last line that was
    torn by a crash is left out with a warning. Raises InputError (file, line) for anything else.
    """
    return list(iterate_poses(path))


def iterate_poses(path: Path | str) -> Iterator[Estimate]:
    """As read_poses, one after another."""
    path = Path(path)
    return without_torn_end((_estimate(cells, path, line) for line, cells in read_csv(path, COLUMNS)), path)


def read_truth(path: Path | str) -> list[TruthPose]:
    """Read truth.csv: frame, stamp_ns and the pose; the other columns of poses.csv may follow and are not read.

    Lines without a pose are left out. Raises InputError (file, line).
    """
    path = Path(path)
    truth: list[TruthPose] = []
    for line, cells in read_csv(path, TRUTH_COLUMNS, COLUMNS[len(TRUTH_COLUMNS) :]):
        T = _pose(cells, path, line)
        if T is not None:
            frame, stamp_ns = integer_cell(cells, "frame", path, line), integer_cell(cells, "stamp_ns", path, line)
            truth.append(TruthPose(frame=frame, stamp_ns=stamp_ns, T_camera_target=T))
    return truth


def _pose(cells: Mapping[str, str], path: Path, line: int) -> Matrix4 | None:
    """T_camera_target of a line; None where all seven cells are empty."""
    if not any(cells[column].strip() for column in POSE_COLUMNS):
        return None
    numbers = np.array([number_cell(cells, column, path, line) for column in POSE_COLUMNS])
    if not np.isfinite(numbers).all():
        raise InputError(path, f"{','.join(POSE_COLUMNS)}: expected finite numbers or seven empty cells", line=line)
    norm = float(np.linalg.norm(numbers[3:]))
    if abs(norm - 1.0) > QUATERNION_TOLERANCE:
        raise InputError(path, f"qx,qy,qz,qw: expected a unit quaternion, got one of norm {norm:.6g}", line=line)
    T = np.eye(4)
    T[:3, :3] = matrix_from_quat_xyzw(numbers[3:])
    T[:3, 3] = numbers[:3]
    return T


def _covariance(cells: Mapping[str, str], path: Path, line: int) -> Matrix6:
    upper = np.zeros((6, 6))
    upper[_UPPER] = [number_cell(cells, column, path, line) for column in COVARIANCE_COLUMNS]
    return upper + np.triu(upper, 1).T


def _estimate(cells: Mapping[str, str], path: Path, line: int) -> Estimate:
    status = cells["status"].strip()
    if status not in get_args(Status):
        raise InputError(path, f"status: expected one of {', '.join(get_args(Status))}, got {status!r}", line=line)
    T = _pose(cells, path, line)
    try:
        return Estimate(
            frame=integer_cell(cells, "frame", path, line),
            stamp_ns=integer_cell(cells, "stamp_ns", path, line),
            status=cast(Status, status),
            reason=cells["reason"],
            T_camera_target=np.full((4, 4), np.nan) if T is None else T,
            covariance=_covariance(cells, path, line),
            n_inliers=integer_cell(cells, "n_inliers", path, line),
            reprojection_rms_px=number_cell(cells, "reprojection_rms_px", path, line),
            information_gained=math.nan,
            reset_counter=0,
            inliers=(),
        )
    except InputError:
        raise
    except ValueError as error:
        raise InputError(path, str(error), line=line) from error


def pose_cells(T_camera_target: Matrix4) -> list[float]:
    """Cells tx ty tz qx qy qz qw."""
    return [*T_camera_target[:3, 3].tolist(), *quat_xyzw_from_matrix(T_camera_target[:3, :3]).tolist()]


def pose_row(estimate: Estimate) -> list[object]:
    """One line of poses.csv in the order of COLUMNS; cells without a finite number are empty."""
    pose: list[float] = [math.nan] * 7
    covariance: list[float] = [math.nan] * 21
    if estimate.ok:
        pose = pose_cells(estimate.T_camera_target)
        covariance = estimate.covariance[_UPPER].tolist()
    numbers = [*pose, *covariance, estimate.reprojection_rms_px]
    cells: list[object] = [number if math.isfinite(number) else "" for number in numbers]
    return [
        *(estimate.frame, estimate.stamp_ns, *cells[:7]),
        *(estimate.status, estimate.reason, *cells[7:28], estimate.n_inliers, cells[28]),
    ]


def write_poses(path: Path | str, estimates: Iterable[Estimate]) -> None:
    """Write poses.csv."""
    with CsvWriter(path, COLUMNS) as writer:
        for estimate in estimates:
            writer.write_rows([pose_row(estimate)])


def write_truth(path: Path | str, truth: Iterable[TruthPose]) -> None:
    """Write truth.csv."""
    with CsvWriter(path, TRUTH_COLUMNS) as writer:
        for pose in truth:
            writer.write_rows([[pose.frame, pose.stamp_ns, *pose_cells(pose.T_camera_target)]])
