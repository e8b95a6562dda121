# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""range.csv <-> RangeReadings, docs/files.md section 8."""

from collections.abc import Iterable
from pathlib import Path

from fairlead.io.csv_lines import CsvWriter, integer_cell, number_cell, read_csv
from fairlead.types import RangeReading

COLUMNS = ("stamp_ns", "range_m", "sigma_m", "landmark")


def read_ranges(path: Path | str) -> list[RangeReading]:
    """Read range.csv; a line without a landmark is a range to the target's origin.

    Stamps may go backwards. Numbers that are empty or not finite come back as such, and the estimator drops them.
    Raises InputError (file, line) for anything else.
    """
    path = Path(path)
    return [
        RangeReading(
            stamp_ns=integer_cell(cells, "stamp_ns", path, line),
            range_m=number_cell(cells, "range_m", path, line),
            sigma_m=number_cell(cells, "sigma_m", path, line),
            landmark=cells["landmark"] or None,
        )
        for line, cells in read_csv(path, COLUMNS)
    ]


def write_ranges(path: Path | str, readings: Iterable[RangeReading]) -> None:
    """Write range.csv."""
    with CsvWriter(path, COLUMNS) as writer:
        writer.write_rows((each.stamp_ns, each.range_m, each.sigma_m, each.landmark or "") for each in readings)
