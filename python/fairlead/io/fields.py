# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Typed access to the tables of a document; every key known, every error names file and key."""

import difflib
import reprlib
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any, cast

import numpy as np

from fairlead.io.errors import InputError

Table = Mapping[str, Any]


def nearest(key: str, known: Collection[str]) -> str:
    """'did you mean' for a misspelt key; lists what is known where nothing is near."""
    close = difflib.get_close_matches(key, known, n=1, cutoff=0.4)
    return f"did you mean {close[0]!r}?" if close else f"known: {', '.join(sorted(known))}"


class Fields:
    """A table of a document being read: typed access, every key known, errors that name file and key."""

    def __init__(self, table: object, known: Collection[str], path: Path, where: str = "") -> None:
        self._path = path
        self._where = where
        if not isinstance(table, Mapping):
            raise InputError(path, f"{where or 'document'}: expected a table, got {_short(table)}")
        self._table = cast(Table, table)
        for key in self._table:
            if key not in known:
                raise InputError(path, f"{self._name(str(key))}: unknown key; {nearest(str(key), known)}")

    def _name(self, key: str) -> str:
        return f"{self._where}.{key}" if self._where else key

    def error(self, key: str, message: str) -> InputError:
        """An InputError that names this key."""
        return InputError(self._path, f"{self._name(key)}: {message}")

    def __contains__(self, key: str) -> bool:
        return key in self._table

    def get(self, key: str) -> object:
        """The raw value; InputError if the key is missing."""
        if key not in self._table:
            raise self.error(key, "missing")
        return self._table[key]

    def text(self, key: str) -> str:
        """A non-empty text."""
        value = self.get(key)
        if not isinstance(value, str) or not value:
            raise self.error(key, f"expected text, got {_short(value)}")
        return value

    def choice(self, key: str, allowed: Collection[str]) -> str:
        """One of the allowed words."""
        value = self.text(key)
        if value not in allowed:
            raise self.error(key, f"expected one of {', '.join(allowed)}, got {value!r}")
        return value

    def number(self, key: str, *, minimum: float = -np.inf) -> float:
        """A finite number >= minimum."""
        value = as_number(self.get(key))
        if value is None or not np.isfinite(value) or value < minimum:
            bound = "" if minimum == -np.inf else f" >= {minimum:g}"
            raise self.error(key, f"expected a number{bound}, got {_short(self.get(key))}")
        return value

    def integer(self, key: str) -> int:
        """A whole number."""
        value = self.get(key)
        if isinstance(value, bool) or not isinstance(value, int):
            raise self.error(key, f"expected a whole number, got {_short(value)}")
        return value

    def items(self, key: str) -> list[object]:
        """A list; empty if the key is missing."""
        value: object = self._table.get(key, [])
        if not isinstance(value, list):
            raise self.error(key, f"expected a list, got {_short(value)}")
        return cast(list[object], value)

    def numbers(self, key: str, count: int | None = None) -> list[float]:
        """A list (or OpenCV matrix) of finite numbers, `count` of them if given."""
        value = self.get(key)
        items = _listed(value)
        if items is None or (count is not None and len(items) != count):
            expected = "a list of numbers" if count is None else f"{count} numbers"
            raise self.error(key, f"expected {expected}, got {_short(value)}")
        numbers = [as_number(item) for item in items]
        finite = [item for item in numbers if item is not None and np.isfinite(item)]
        if len(finite) != len(numbers):
            raise self.error(key, f"expected finite numbers, got {_short(value)}")
        return finite


def as_number(value: object) -> float | None:
    """A float from a whole or decimal number; None for anything else."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        return float(value)
    except OverflowError:
        return None


def _listed(value: object) -> list[object] | None:
    if isinstance(value, np.ndarray):
        return cast(list[object], cast(np.ndarray, value).ravel().tolist())
    return cast(list[object], value) if isinstance(value, list) else None


def _short(value: object, limit: int = 80) -> str:
    if isinstance(value, Mapping):
        return "a table"
    text = reprlib.repr(value)
    return text if len(text) <= limit else text[:limit] + "..."
