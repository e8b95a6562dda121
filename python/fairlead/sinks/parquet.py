# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""poses.parquet: the columns of poses.csv, written when the run ends; until then poses.csv has them."""

import importlib
from pathlib import Path
from typing import Any

from fairlead.io.poses import COLUMNS, pose_row
from fairlead.sinks.sink import Outcome

pa: Any = importlib.import_module("pyarrow")  # pyarrow carries no types
pq: Any = importlib.import_module("pyarrow.parquet")

_WHOLE = ("frame", "stamp_ns", "n_inliers")
_TEXT = ("status", "reason")
_BATCH_ROWS = 4096


def _kind(column: str) -> Any:
    if column in _WHOLE:
        return pa.int64()
    return pa.string() if column in _TEXT else pa.float64()


_SCHEMA = pa.schema([(column, _kind(column)) for column in COLUMNS])


class ParquetSink:
    """The file appears when it is complete; cells that are empty in poses.csv are null."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._part = path.with_name(f".{path.name}.part")
        self._writer: Any = pq.ParquetWriter(self._part, _SCHEMA)
        self._rows: list[list[object]] = []

    def write(self, outcome: Outcome) -> None:
        """Append one row."""
        self._rows.append(pose_row(outcome.estimate))
        if len(self._rows) >= _BATCH_ROWS:
            self._write_rows()

    def _write_rows(self) -> None:
        columns = [[_cell(row[i], column) for row in self._rows] for i, column in enumerate(COLUMNS)]
        arrays = [pa.array(cells, type=field.type) for cells, field in zip(columns, _SCHEMA, strict=True)]
        self._writer.write_batch(pa.record_batch(arrays, schema=_SCHEMA))
        self._rows = []

    def close(self) -> None:
        """Put the file in its place; safe to call twice."""
        if self._writer is None:
            return
        self._write_rows()
        self._writer.close()
        self._writer = None
        self._part.replace(self._path)


def _cell(value: object, column: str) -> object:
    return None if value == "" and column not in _TEXT else value
