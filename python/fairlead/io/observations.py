# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""observations.csv and .parquet <-> Views, streamed, one View per frame, docs/files.md."""

import math
from collections import deque
from collections.abc import Iterable, Iterator
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fairlead.io.csv_lines import CsvWriter, count_lines, integer_cell, number_cell, read_csv, without_torn_end
from fairlead.io.errors import InputError
from fairlead.types import View

COLUMNS = ("frame", "stamp_ns", "landmark", "u_px", "v_px", "var_u", "cov_uv", "var_v")
OPTIONAL_COLUMNS = ("score",)

_FRAMES_REMEMBERED = 65536


class Row(NamedTuple):
    """One line of the table; numbers may be NaN, the landmark is empty where nothing was seen."""

    line: int
    frame: int
    stamp_ns: int
    landmark: str
    numbers: tuple[float, float, float, float, float]
    """u_px, v_px, var_u, cov_uv, var_v."""
    score: float


def read_views(path: Path | str) -> Iterator[View]:
    """Stream the views of observations.csv or .parquet; memory does not grow with the file.

    A row without a landmark says that the frame was seen and nothing found. Cells that are empty or not finite become
    NaN, which the estimator drops. Stamps may go backwards. Raises InputError (file, line) for anything else.
    """
    path = Path(path)
    if path.suffix == ".csv":
        return _views(_csv_rows(path), path)
    if path.suffix == ".parquet":
        from fairlead.io.observations_parquet import parquet_rows

        return _views(parquet_rows(path), path)
    raise InputError(path, "expected a table of observations ending in .csv or .parquet")


def read_recorded_views(path: Path | str) -> Iterator[View]:
    """As read_views, of the observations.csv that a run wrote.

    A last line that was torn by a crash is left out with a warning, as of poses.csv. Raises InputError (file, line)
    for anything else.
    """
    path = Path(path)
    return _views(without_torn_end(_csv_rows(path), path), path)


def count_observations(path: Path | str) -> int:
    """Number of rows, for the progress of a long run: exact for Parquet, lines for CSV. Raises InputError."""
    path = Path(path)
    if path.suffix == ".parquet":
        from fairlead.io.observations_parquet import count_rows

        return count_rows(path)
    return count_lines(path) - 1


def _csv_rows(path: Path) -> Iterator[Row]:
    for line, cells in read_csv(path, COLUMNS, OPTIONAL_COLUMNS):
        yield Row(
            line=line,
            frame=integer_cell(cells, "frame", path, line),
            stamp_ns=integer_cell(cells, "stamp_ns", path, line),
            landmark=cells["landmark"],
            numbers=(
                number_cell(cells, "u_px", path, line),
                number_cell(cells, "v_px", path, line),
                number_cell(cells, "var_u", path, line),
                number_cell(cells, "cov_uv", path, line),
                number_cell(cells, "var_v", path, line),
            ),
            score=number_cell(cells, "score", path, line) if "score" in cells else math.nan,
        )


def _views(rows: Iterable[Row], path: Path) -> Iterator[View]:
    """Group rows by frame. Rows of one frame must stand together and share their stamp."""
    seen: set[int] = set()
    order: deque[int] = deque()
    for frame, group in groupby(rows, key=lambda row: row.frame):
        members = list(group)
        first = members[0]
        if frame in seen:
            raise InputError(path, f"rows of frame {frame} do not stand together: sort by frame", line=first.line)
        for row in members:
            if row.stamp_ns != first.stamp_ns:
                message = f"frame {frame} has stamp_ns {first.stamp_ns} and {row.stamp_ns}; expected one"
                raise InputError(path, message, line=row.line)
        seen.add(frame)
        order.append(frame)
        if len(order) > _FRAMES_REMEMBERED:
            seen.discard(order.popleft())
        yield _view([row for row in members if row.landmark], frame, first.stamp_ns)


def _view(rows: list[Row], frame: int, stamp_ns: int) -> View:
    numbers = np.array([row.numbers for row in rows], dtype=np.float64).reshape(-1, 5)
    scores = np.array([row.score for row in rows], dtype=np.float64)
    return View(
        frame=frame,
        stamp_ns=stamp_ns,
        landmarks=tuple(row.landmark for row in rows),
        pixels=numbers[:, :2],
        covariances=numbers[:, [2, 3, 3, 4]].reshape(-1, 2, 2),
        scores=scores if np.isfinite(scores).any() else None,
    )


class ObservationWriter:
    """observations.csv, one view after another; each is on its way to the disk when `write` returns."""

    def __init__(self, path: Path | str, *, with_scores: bool = False) -> None:
        self._with_scores = with_scores
        self._writer = CsvWriter(path, COLUMNS + (OPTIONAL_COLUMNS if with_scores else ()))

    def write(self, view: View) -> None:
        """Append one view; an empty one becomes a row without a landmark."""
        self._writer.write_rows(view_rows(view, with_scores=self._with_scores))

    def close(self) -> None:
        """Close the file."""
        self._writer.close()

    def __enter__(self) -> "ObservationWriter":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def view_rows(view: View, *, with_scores: bool) -> list[tuple[object, ...]]:
    """The rows of one view in the order of COLUMNS."""
    tail: tuple[object, ...] = ("",) if with_scores else ()
    if not view.landmarks:
        return [(view.frame, view.stamp_ns, "", "", "", "", "", "", *tail)]
    scores = [math.nan] * len(view.landmarks) if view.scores is None else view.scores.tolist()
    rows: list[tuple[object, ...]] = []
    for name, (u, v), covariance, score in zip(
        view.landmarks, view.pixels.tolist(), view.covariances.tolist(), scores, strict=True
    ):
        tail = (score,) if with_scores else ()
        numbers = (u, v, covariance[0][0], covariance[0][1], covariance[1][1])
        rows.append((view.frame, view.stamp_ns, name, *numbers, *tail))
    return rows


def write_views(path: Path | str, views: Iterable[View], *, with_scores: bool = False) -> None:
    """Write observations.csv, or .parquet at once at the end."""
    path = Path(path)
    if path.suffix == ".parquet":
        from fairlead.io.observations_parquet import write_parquet

        write_parquet(path, views)
        return
    with ObservationWriter(path, with_scores=with_scores) as writer:
        for view in views:
            writer.write(view)
