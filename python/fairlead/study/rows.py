# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Rows of a study on disk: an Arrow stream while it runs, Parquet when it is done; one row per run and method."""

import importlib
import io
import itertools
from collections.abc import Generator, Iterable
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fairlead.io.errors import InputError
from fairlead.study.block import Result
from fairlead.study.scores import COLUMNS

pa: Any = importlib.import_module("pyarrow")  # pyarrow carries no types
ipc: Any = importlib.import_module("pyarrow.ipc")
pq: Any = importlib.import_module("pyarrow.parquet")

STREAM = "rows.arrows"
TABLE = "rows.parquet"
_VALUES = ("sigma_px", "angle_deg", "model_sigma_m", "outlier_fraction")
SCHEMA = pa.schema(
    [
        ("setting", pa.string()),
        *((name, pa.float64()) for name in _VALUES),
        ("views", pa.int32()),
        ("run", pa.int32()),
        ("method", pa.string()),
        *((name, pa.float64()) for name in COLUMNS),
    ]
)


def as_batch(result: Result) -> Any:
    """The rows of a block as a record batch."""
    columns: dict[str, list[Any]] = {name: [] for name in SCHEMA.names}
    setting, n = result.setting, len(result.runs)
    for method, values in result.columns.items():
        columns["setting"] += [setting.name] * n
        for name in (*_VALUES, "views"):
            columns[name] += [getattr(setting, name)] * n
        columns["run"] += result.runs
        columns["method"] += [method] * n
        for name in COLUMNS:
            columns[name] += values[name].tolist()
    return pa.record_batch([pa.array(columns[field.name], type=field.type) for field in SCHEMA], schema=SCHEMA)


def read_rows(folder: Path) -> Any:
    """What is there: the stream up to where it was cut off, which holds all that the table held; else the table.

    Raises InputError for another program's files.
    """
    try:
        if (folder / STREAM).exists():
            return _read_stream(folder / STREAM)
        if (folder / TABLE).exists():
            return pq.read_table(folder / TABLE).cast(SCHEMA)
    except (pa.ArrowException, ValueError) as error:
        raise InputError(folder, f"no readable rows of a study: {error}") from error
    return SCHEMA.empty_table()


def _read_stream(path: Path) -> Any:
    """Complete batches; a batch that was being written when the program ended is left out."""
    batches: list[Any] = []
    try:
        reader = ipc.open_stream(io.BytesIO(path.read_bytes()))
        while True:
            batches.append(reader.read_next_batch())
    except (StopIteration, pa.ArrowInvalid, OSError):
        pass
    if batches and not batches[0].schema.equals(SCHEMA):
        raise ValueError(f"{path.name} has other columns")
    return pa.Table.from_batches(batches, schema=SCHEMA)


def runs_done(rows: Any, methods: int) -> dict[str, set[int]]:
    """By setting, the runs that all methods have done."""
    counts = rows.group_by(["setting", "run"]).aggregate([("method", "count")]).to_pydict()
    done: dict[str, set[int]] = {}
    for setting, run, count in zip(counts["setting"], counts["run"], counts["method_count"], strict=True):
        if count == methods:
            done.setdefault(setting, set()).add(run)
    return done


@dataclass(frozen=True, kw_only=True)
class RowStream:
    """Where results go; each is with the operating system when `write` returns."""

    writer: Any

    def write(self, result: Result) -> None:
        """Append the rows of a block."""
        self.writer.write_batch(as_batch(result))


@contextmanager
def row_stream(folder: Path, rows: Any) -> Generator[RowStream]:
    """Write `rows`, then what comes; the new stream takes the old one's place once it holds what that held."""
    temporary = folder / f".{STREAM}.part"
    with temporary.open("wb", buffering=0) as file, ipc.new_stream(file, SCHEMA) as writer:
        writer.write_table(rows)
        temporary.replace(folder / STREAM)
        yield RowStream(writer=writer)


def close_rows(folder: Path) -> Any:
    """Turn the stream into the table; returns the rows, in the order of settings as they came."""
    rows = _read_stream(folder / STREAM)
    temporary = folder / f".{TABLE}.part"
    pq.write_table(rows, temporary, compression="zstd")
    temporary.replace(folder / TABLE)
    (folder / STREAM).unlink()
    return rows


def results_of(rows: Any, names: Iterable[str]) -> dict[tuple[str, str], dict[str, np.ndarray]]:
    """(setting, method) -> column -> values in the order of the runs."""
    table = rows.sort_by([("setting", "ascending"), ("method", "ascending"), ("run", "ascending")])
    if not table.num_rows:
        return {}
    settings, methods = (table.column(name).to_numpy(zero_copy_only=False) for name in ("setting", "method"))
    changes = np.flatnonzero((settings[1:] != settings[:-1]) | (methods[1:] != methods[:-1])) + 1
    bounds = [0, *changes.tolist(), table.num_rows]
    values = {name: table.column(name).to_numpy() for name in ("run", *names)}
    return {
        (str(settings[a]), str(methods[a])): {name: each[a:b] for name, each in values.items()}
        for a, b in itertools.pairwise(bounds)
    }
