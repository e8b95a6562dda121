# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""timing.csv: how long each frame took, beside poses.csv."""

import math
from dataclasses import dataclass
from pathlib import Path

from fairlead.io.csv_lines import integer_cell, number_cell, read_csv

COLUMNS = ("frame", "stamp_ns", "detect_ms", "update_ms", "read_ms", "sinks_ms")
_REQUIRED = 4


@dataclass(frozen=True, kw_only=True)
class Timing:
    """Wall time of one frame."""

    frame: int
    stamp_ns: int
    detect_ms: float
    """Finding the landmarks [ms]; of a table: reading it."""
    update_ms: float
    """The estimator's update alone [ms]."""
    read_ms: float = math.nan
    """Reading and decoding the image [ms]; NaN where there is none."""
    sinks_ms: float = math.nan
    """Writing everything but this line [ms]."""


def timing_row(timing: Timing) -> list[object]:
    """One line in the order of COLUMNS."""
    times_ms = (timing.detect_ms, timing.update_ms, timing.read_ms, timing.sinks_ms)
    return [timing.frame, timing.stamp_ns, *(f"{time_ms:.4f}" for time_ms in times_ms)]


def read_timing(path: Path | str) -> list[Timing]:
    """Read timing.csv; its last two columns may be missing. Raises InputError (file, line)."""
    path = Path(path)
    return [
        Timing(
            frame=integer_cell(cells, "frame", path, line),
            stamp_ns=integer_cell(cells, "stamp_ns", path, line),
            detect_ms=number_cell(cells, "detect_ms", path, line),
            update_ms=number_cell(cells, "update_ms", path, line),
            read_ms=number_cell(cells, "read_ms", path, line) if "read_ms" in cells else math.nan,
            sinks_ms=number_cell(cells, "sinks_ms", path, line) if "sinks_ms" in cells else math.nan,
        )
        for line, cells in read_csv(path, COLUMNS[:_REQUIRED], COLUMNS[_REQUIRED:])
    ]
