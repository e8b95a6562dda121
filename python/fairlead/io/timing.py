# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""timing.csv: how long each frame took, beside poses.csv."""

from dataclasses import dataclass
from pathlib import Path

from fairlead.io.csv_lines import integer_cell, number_cell, read_csv

COLUMNS = ("frame", "stamp_ns", "detect_ms", "update_ms")


@dataclass(frozen=True, kw_only=True)
class Timing:
    """Wall time of one frame."""

    frame: int
    stamp_ns: int
    detect_ms: float
    """Reading and detecting [ms]."""
    update_ms: float
    """The estimator's update alone [ms]."""


def timing_row(timing: Timing) -> list[object]:
    """One line in the order of COLUMNS."""
    return [timing.frame, timing.stamp_ns, f"{timing.detect_ms:.4f}", f"{timing.update_ms:.4f}"]


def read_timing(path: Path | str) -> list[Timing]:
    """Read timing.csv. Raises InputError (file, line)."""
    path = Path(path)
    return [
        Timing(
            frame=integer_cell(cells, "frame", path, line),
            stamp_ns=integer_cell(cells, "stamp_ns", path, line),
            detect_ms=number_cell(cells, "detect_ms", path, line),
            update_ms=number_cell(cells, "update_ms", path, line),
        )
        for line, cells in read_csv(path, COLUMNS)
    ]
