# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""observations.parquet: the columns of observations.csv, read batch by batch."""

import importlib
import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from fairlead.io.errors import InputError
from fairlead.io.observations import COLUMNS, OPTIONAL_COLUMNS, Row, view_rows
from fairlead.types import View

pa: Any = importlib.import_module("pyarrow")  # pyarrow carries no types
pq: Any = importlib.import_module("pyarrow.parquet")

_BATCH_ROWS = 4096
_SCHEMA = pa.schema(
    [
        ("frame", pa.int64()),
        ("stamp_ns", pa.int64()),
        ("landmark", pa.string()),
        *((name, pa.float64()) for name in (*COLUMNS[3:], *OPTIONAL_COLUMNS)),
    ]
)


def parquet_rows(path: Path) -> Iterator[Row]:
    """Rows of the table; `line` counts rows from 1."""
    line = 0
    try:
        with pq.ParquetFile(path) as table:
            _check_columns(table.schema_arrow, path)
            for batch in table.iter_batches(batch_size=_BATCH_ROWS):
                columns: dict[str, list[Any]] = batch.to_pydict()
                scores = columns["score"] if "score" in columns else [math.nan] * int(batch.num_rows)
                for cells in zip(*(columns[name] for name in COLUMNS), scores, strict=True):
                    line += 1
                    yield _row(line, cells, path)
    except (pa.ArrowException, OSError, ValueError, MemoryError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(path, f"no readable Parquet table: {error}") from error


def count_rows(path: Path) -> int:
    """Rows of the table, from its footer. Raises InputError."""
    try:
        return int(pq.read_metadata(path).num_rows)
    except (pa.ArrowException, OSError, ValueError) as error:
        raise InputError(path, f"no readable Parquet table: {error}") from error


def _row(line: int, cells: tuple[Any, ...], path: Path) -> Row:
    frame, stamp_ns, landmark, *numbers = cells
    if frame is None or stamp_ns is None:
        raise InputError(path, "frame and stamp_ns: expected whole numbers, got an empty cell", line=line)
    u, v, var_u, cov_uv, var_v, score = (math.nan if number is None else float(number) for number in numbers)
    return Row(line, int(frame), int(stamp_ns), str(landmark or ""), (u, v, var_u, cov_uv, var_v), score)


def _check_columns(schema: Any, path: Path) -> None:
    names: list[str] = schema.names
    missing = [name for name in COLUMNS if name not in names]
    if missing or len(set(names)) != len(names):
        raise InputError(path, f"expected columns {','.join(COLUMNS)}, got {','.join(names)}")
    for name in ("frame", "stamp_ns"):
        if not pa.types.is_integer(schema.field(name).type):
            raise InputError(path, f"{name}: expected whole numbers, got {schema.field(name).type}")
    for name in (*COLUMNS[3:], *OPTIONAL_COLUMNS):
        if name in names and not _is_number(schema.field(name).type):
            raise InputError(path, f"{name}: expected numbers, got {schema.field(name).type}")


def _is_number(kind: Any) -> bool:
    return bool(pa.types.is_floating(kind) or pa.types.is_integer(kind))


def write_parquet(path: Path, views: Iterable[View]) -> None:
    """Write all views; the file appears when it is complete."""
    temporary = path.with_name(f".{path.name}.part")
    rows: list[tuple[object, ...]] = []
    with pq.ParquetWriter(temporary, _SCHEMA) as writer:
        for view in views:
            rows += view_rows(view, with_scores=True)
            if len(rows) >= _BATCH_ROWS:
                writer.write_batch(_batch(rows))
                rows = []
        writer.write_batch(_batch(rows))
    temporary.replace(path)


def _batch(rows: list[tuple[object, ...]]) -> Any:
    columns = [[None if row[index] == "" else row[index] for row in rows] for index in range(len(_SCHEMA))]
    arrays = [pa.array(column, type=field.type) for column, field in zip(columns, _SCHEMA, strict=True)]
    return pa.record_batch(arrays, schema=_SCHEMA)
