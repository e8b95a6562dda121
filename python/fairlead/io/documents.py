# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""TOML and YAML documents from people: size and nesting are capped, every fault becomes one InputError."""

import difflib
import re
import tomllib
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any, cast

import numpy as np
import yaml

from fairlead.io.errors import InputError

MAX_DOCUMENT_BYTES = 16 * 1024 * 1024
"""Largest TOML, YAML or text document that is read [byte]."""
MAX_NESTING = 32
"""Deepest nesting of a YAML document."""

Table = Mapping[str, Any]


def read_text(path: Path, limit_bytes: int = MAX_DOCUMENT_BYTES) -> str:
    """Read a UTF-8 text of at most `limit_bytes`; InputError otherwise."""
    try:
        with path.open("rb") as stream:
            raw = stream.read(limit_bytes + 1)
    except (OSError, ValueError) as error:
        raise InputError(path, f"cannot be read: {describe_os_error(error)}") from error
    if len(raw) > limit_bytes:
        raise InputError(path, f"larger than {limit_bytes} bytes: this is no document of this kind")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw[: error.start].count(b"\n") + 1
        raise InputError(path, f"byte {raw[error.start]:#04x} is not UTF-8 text", line=line) from error


def describe_os_error(error: Exception) -> str:
    """What the operating system said, without the path, which the message names already."""
    strerror = getattr(error, "strerror", None)
    return str(strerror) if strerror else str(error)


def read_toml(path: Path) -> Table:
    """Read a TOML document; InputError with the line where it is malformed."""
    text = read_text(path)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(path, f"malformed TOML: {error}") from error
    except (RecursionError, ValueError, OverflowError) as error:
        raise InputError(path, f"malformed TOML: {error}") from error


def read_yaml(path: Path) -> Table:
    """Read a YAML mapping, OpenCV's matrices included; InputError with the line where it is malformed."""
    text = read_text(path)
    if text.startswith("%YAML:"):  # OpenCV's header is no valid YAML directive
        text = "#" + text
    try:
        document = yaml.load(text, Loader=_Loader)  # noqa: S506 - a SafeLoader
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = None if mark is None else mark.line + 1
        raise InputError(path, f"malformed YAML: {error.problem or error.context}", line=line) from error
    except (yaml.YAMLError, RecursionError, ValueError, OverflowError, TypeError, AttributeError, KeyError) as error:
        raise InputError(path, f"malformed YAML: {error}") from error
    if not isinstance(document, dict):
        raise InputError(path, f"expected a YAML mapping, got {type(document).__name__}")
    return cast(Table, document)


class _Loader(yaml.SafeLoader):
    """SafeLoader that refuses aliases, deep nesting and a key that comes twice."""

    _depth = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        if self.check_event(yaml.AliasEvent):
            event = self.peek_event()
            raise yaml.composer.ComposerError(None, None, "aliases are not allowed here", event.start_mark)
        self._depth += 1
        if self._depth > MAX_NESTING:
            event = self.peek_event()
            raise yaml.composer.ComposerError(None, None, f"nested deeper than {MAX_NESTING}", event.start_mark)
        node = super().compose_node(parent, index)
        self._depth -= 1
        return node

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        seen: set[str] = set()
        for key, _ in node.value:
            if key.value in seen:
                raise yaml.constructor.ConstructorError(None, None, f"key {key.value!r} comes twice", key.start_mark)
            if isinstance(key.value, str):
                seen.add(key.value)
        return super().construct_mapping(node, deep)


def _opencv_matrix(loader: _Loader, node: yaml.Node) -> np.ndarray:
    """OpenCV's matrix {rows, cols, dt, data} or {sizes, dt, data} as float64, reshaped."""
    if not isinstance(node, yaml.MappingNode):
        raise yaml.constructor.ConstructorError(None, None, "expected an OpenCV matrix", node.start_mark)
    fields = loader.construct_mapping(node, deep=True)
    try:
        shape = tuple(int(size) for size in fields.get("sizes", (fields.get("rows"), fields.get("cols"))))
        data = np.array([float(value) for value in fields["data"]], dtype=np.float64)
        return data.reshape(shape)
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        problem = f"malformed OpenCV matrix: {error}"
        raise yaml.constructor.ConstructorError(None, None, problem, node.start_mark) from error


# YAML 1.1 takes 1e-3 for text, because it has no point; calibration files mean a number
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float", re.compile(r"[-+]?[0-9]+(\.[0-9]*)?[eE][-+]?[0-9]+$"), list("-+0123456789")
)
for _tag in ("opencv-matrix", "opencv-nd-matrix"):
    _Loader.add_constructor(f"tag:yaml.org,2002:{_tag}", _opencv_matrix)


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
        value = self._table.get(key, [])
        if not isinstance(value, list):
            raise self.error(key, f"expected a list, got {_short(value)}")
        return cast(list[object], value)

    def numbers(self, key: str, count: int | None = None) -> list[float]:
        """A list (or OpenCV matrix) of finite numbers, `count` of them if given."""
        value = self.get(key)
        if isinstance(value, np.ndarray):
            value = cast(list[object], value.ravel().tolist())
        if not isinstance(value, list) or (count is not None and len(cast(list[object], value)) != count):
            expected = "a list of numbers" if count is None else f"{count} numbers"
            raise self.error(key, f"expected {expected}, got {_short(value)}")
        numbers = [as_number(item) for item in cast(list[object], value)]
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


def _short(value: object, limit: int = 80) -> str:
    if isinstance(value, Mapping):
        return "a table"
    text = repr(cast(object, value))
    return text if len(text) <= limit else text[:limit] + "..."
