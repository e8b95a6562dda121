# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""poses.csv and timing.csv; each line is on its way to the disk when `write` returns."""

from pathlib import Path

from fairlead.io.csv_lines import CsvWriter
from fairlead.io.poses import COLUMNS as POSE_COLUMNS
from fairlead.io.poses import pose_row
from fairlead.io.timing import COLUMNS as TIMING_COLUMNS
from fairlead.io.timing import Timing, timing_row
from fairlead.types import Estimate


class PoseSink:
    """poses.csv."""

    def __init__(self, path: Path) -> None:
        self._writer = CsvWriter(path, POSE_COLUMNS)

    def write(self, estimate: Estimate) -> None:
        """Append one line."""
        self._writer.write_rows([pose_row(estimate)])

    def close(self) -> None:
        """Close the file."""
        self._writer.close()


class TimingSink:
    """timing.csv."""

    def __init__(self, path: Path) -> None:
        self._writer = CsvWriter(path, TIMING_COLUMNS)

    def write(self, timing: Timing) -> None:
        """Append one line."""
        self._writer.write_rows([timing_row(timing)])

    def close(self) -> None:
        """Close the file."""
        self._writer.close()
