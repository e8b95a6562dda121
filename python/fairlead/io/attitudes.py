# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""attitude.csv <-> AttitudeReadings, docs/files.md section 9."""

from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from fairlead.geometry import matrix_from_quat_xyzw, quat_xyzw_from_matrix
from fairlead.io.csv_lines import CsvWriter, integer_cell, number_cell, read_csv
from fairlead.io.errors import InputError
from fairlead.io.poses import QUATERNION_TOLERANCE
from fairlead.types import AttitudeReading, Matrix3

QUATERNION_COLUMNS = ("qx", "qy", "qz", "qw")
COLUMNS = ("stamp_ns", *QUATERNION_COLUMNS, "sigma_rad")


def read_attitudes(path: Path | str) -> list[AttitudeReading]:
    """Read attitude.csv: R_world_camera as a unit quaternion, CONVENTIONS.md eq. (11).

    Lines whose four cells are empty say that there was no attitude and are left out; stamps may go backwards. Raises
    InputError (file, line) for anything else.
    """
    path = Path(path)
    readings: list[AttitudeReading] = []
    for line, cells in read_csv(path, COLUMNS):
        stamp_ns = integer_cell(cells, "stamp_ns", path, line)
        sigma_rad = number_cell(cells, "sigma_rad", path, line)
        R = _rotation(cells, path, line)
        if R is not None:
            readings.append(AttitudeReading(stamp_ns=stamp_ns, R_world_camera=R, sigma_rad=sigma_rad))
    return readings


def _rotation(cells: Mapping[str, str], path: Path, line: int) -> Matrix3 | None:
    if not any(cells[column].strip() for column in QUATERNION_COLUMNS):
        return None
    quat_xyzw = np.array([number_cell(cells, column, path, line) for column in QUATERNION_COLUMNS])
    norm = float(np.linalg.norm(quat_xyzw))
    if not abs(norm - 1.0) <= QUATERNION_TOLERANCE:
        raise InputError(path, f"qx,qy,qz,qw: expected a unit quaternion, got one of norm {norm:.6g}", line=line)
    return matrix_from_quat_xyzw(quat_xyzw)


def write_attitudes(path: Path | str, readings: Iterable[AttitudeReading]) -> None:
    """Write attitude.csv."""
    with CsvWriter(path, COLUMNS) as writer:
        for each in readings:
            quat_xyzw = quat_xyzw_from_matrix(each.R_world_camera)
            writer.write_rows([(each.stamp_ns, *quat_xyzw.tolist(), each.sigma_rad)])
