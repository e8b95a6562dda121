# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""CSV tables: read line by line with errors that name the line; written so that whole lines survive a kill."""

import csv
import io
import logging
import math
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TypeVar, cast

from fairlead.io.documents import describe_os_error
from fairlead.io.errors import InputError
from fairlead.io.fields import nearest

MAX_LINE_BYTES = 65536

_log = logging.getLogger(__name__)

_Row = TypeVar("_Row")


def read_csv(
    path: Path, columns: Sequence[str], optional: Sequence[str] = ()
) -> Iterator[tuple[int, Mapping[str, str]]]:
    """Yield (line number, cell by column). All of `columns` must be there, in any order, and none but `optional`."""
    lines = _Lines(path)
    try:
        reader = csv.reader(lines, strict=True)
        header = [name.strip() for name in next(reader, cast(list[str], []))]
        _check_header(header, columns, optional, path)
        for cells in reader:
            if not cells:
                continue
            if len(cells) != len(header):
                raise InputError(path, f"expected {len(header)} cells, got {len(cells)}", line=lines.number)
            yield lines.number, dict(zip(header, cells, strict=True))
    except csv.Error as error:
        raise InputError(path, f"malformed CSV: {error}", line=lines.number) from error
    finally:
        lines.close()


def _check_header(header: list[str], columns: Sequence[str], optional: Sequence[str], path: Path) -> None:
    expected = f"expected {','.join(columns)}" + "".join(f"[,{name}]" for name in optional)
    for name in header:
        if name not in columns and name not in optional:
            known = [*columns, *optional]
            raise InputError(path, f"unknown column {name[:40]!r}; {nearest(name[:40], known)}; {expected}", line=1)
    missing = [name for name in columns if name not in header]
    if missing or len(set(header)) != len(header):
        came = ",".join(header) or "an empty file"
        raise InputError(path, f"{expected}, got {came}", line=1)


class _Lines(Iterator[str]):
    """Lines of a UTF-8 file, counted, none longer than MAX_LINE_BYTES."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.number = 0
        try:
            self._stream = path.open("rb")
        except (OSError, ValueError) as error:
            raise InputError(path, f"cannot be read: {describe_os_error(error)}") from error

    def __next__(self) -> str:
        try:
            raw = self._stream.readline(MAX_LINE_BYTES + 1)
        except OSError as error:
            raise InputError(self._path, f"cannot be read: {describe_os_error(error)}", line=self.number + 1) from error
        if not raw:
            raise StopIteration
        self.number += 1
        if len(raw) > MAX_LINE_BYTES:
            raise InputError(self._path, f"line longer than {MAX_LINE_BYTES} bytes: no CSV", line=self.number)
        try:
            return raw.decode("utf-8-sig" if self.number == 1 else "utf-8")
        except UnicodeDecodeError as error:
            message = f"byte {raw[error.start]:#04x} is not UTF-8 text"
            raise InputError(self._path, message, line=self.number) from error

    def close(self) -> None:
        self._stream.close()


def without_torn_end(rows: Iterator[_Row], path: Path) -> Iterator[_Row]:
    """The rows that are read from a file; a last line that was torn by a crash is left out with a warning.

    Raises InputError as `rows` does for anything else.
    """
    while True:
        try:
            row = next(rows)
        except StopIteration:
            return
        except InputError as error:
            if not _is_torn(path, error.line):
                raise
            _log.warning("%s: the last line is torn and left out", path)
            return
        yield row


def _is_torn(path: Path, line: int | None) -> bool:
    """Whether this is the last line and does not end with a line feed (or its bytes are no text)."""
    if line is None or line == 1:
        return False
    data = path.read_bytes()
    return not data.endswith(b"\n") and data.count(b"\n") + 1 == line


def count_lines(path: Path) -> int:
    """Line feeds of a file. Raises InputError if it cannot be read."""
    try:
        with path.open("rb") as stream:
            return sum(block.count(b"\n") for block in iter(lambda: stream.read(1 << 20), b""))
    except (OSError, ValueError) as error:
        raise InputError(path, f"cannot be read: {describe_os_error(error)}") from error


def integer_cell(cells: Mapping[str, str], column: str, path: Path, line: int) -> int:
    """A whole number that fits 64 bits."""
    text = cells[column].strip()
    digits = text[1:] if text[:1] in ("-", "+") else text
    if digits.isascii() and digits.isdigit() and len(digits) <= 19 and -(2**63) <= int(text) < 2**63:
        return int(text)
    raise InputError(path, f"{column}: expected a whole number, got {text[:40]!r}", line=line)


def number_cell(cells: Mapping[str, str], column: str, path: Path, line: int) -> float:
    """A number; NaN for an empty cell."""
    text = cells[column].strip()
    if not text:
        return math.nan
    try:
        if "_" in text:  # Python would take 1_0 for 10
            raise ValueError
        return float(text)
    except ValueError:
        raise InputError(path, f"{column}: expected a number, got {text[:40]!r}", line=line) from None


class CsvWriter:
    """A table written row by row, unbuffered: what `write_rows` took survives kill -9; a torn row is cut off.

    Floats are written in the shortest form that reads back exactly. Raises OSError where the disk is full.
    """

    def __init__(self, path: Path | str, columns: Sequence[str]) -> None:
        self._stream = Path(path).open("wb", buffering=0)  # noqa: SIM115 - closed by close()
        self._path = Path(path)
        self._columns = len(columns)
        try:
            self.write_rows([columns])
        except OSError:
            self.close()
            raise

    def write_rows(self, rows: Iterable[Sequence[object]]) -> None:
        """Append rows in one go."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        for row in rows:
            if len(row) != self._columns:
                raise ValueError(f"expected {self._columns} cells, got {len(row)}")
            writer.writerow(row)
        self._append(text.getvalue().encode("utf-8"))

    def _append(self, data: bytes) -> None:
        start = self._stream.tell() if self._stream.seekable() else None
        try:
            while data:
                data = data[self._stream.write(data) :]
        except OSError as error:
            if start is not None:
                self._cut(start)
            raise OSError(error.errno, error.strerror, str(self._path)) from error

    def _cut(self, size: int) -> None:
        try:
            os.ftruncate(self._stream.fileno(), size)
        except OSError:  # a device; nothing to cut
            return

    def close(self) -> None:
        """Close the file; safe to call twice."""
        self._stream.close()

    def __enter__(self) -> "CsvWriter":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
