# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A TOML table <-> a frozen record: each key a field, each value of the type of the field, no key unknown."""

import dataclasses
import json
import types
import typing
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, TypeVar, Union, cast

from fairlead.io.errors import InputError
from fairlead.io.fields import Fields
from fairlead.io.paths import resolve_inside

Record = TypeVar("Record")

LARGEST = 1e9
"""No number of a scenario is larger; what is computed of it then stays finite."""


def read_record(
    record_type: type[Record],
    table: object,
    path: Path,
    where: str,
    given: Mapping[str, object] = types.MappingProxyType({}),
) -> Record:
    """A record from its table; missing keys keep their defaults. Raises InputError: file, key, what was expected.

    `given` are fields that the caller has read already.
    """
    declared = dataclasses.fields(cast(Any, record_type))
    fields = Fields(table, [field.name for field in declared], path, where)
    hints = typing.get_type_hints(record_type)
    values = dict(given)
    for field in declared:
        key = field.name
        if key not in values and key in fields:
            values[key] = _value(hints[key], fields, key, path, _join(where, key))
            if _largest(values[key]) > LARGEST:
                raise fields.error(key, f"expected numbers up to {LARGEST:g}, got {fields.get(key)!r}"[:160])
        if key not in values and field.default is field.default_factory is dataclasses.MISSING:
            raise fields.error(key, "missing")
    try:
        return record_type(**values)
    except InputError:
        raise
    except ValueError as error:
        raise InputError(path, _join(where, str(error))) from error


def _largest(value: object) -> float:
    """Largest magnitude of the numbers in a value; 0 where there is none."""
    if isinstance(value, Mapping):
        return max(map(_largest, cast(Mapping[str, object], value).values()), default=0.0)
    if isinstance(value, tuple):
        return max(map(_largest, cast(tuple[object, ...], value)), default=0.0)
    return abs(value) if isinstance(value, float) else 0.0


def _join(where: str, key: str) -> str:
    return f"{where}.{key}" if where else key


def _value(hint: Any, fields: Fields, key: str, path: Path, where: str) -> object:
    """The value of one key as this type."""
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if origin in (Union, types.UnionType):
        kinds = [each for each in arguments if each is not types.NoneType]
        if len(kinds) > 1:  # one number or several
            kinds = [each for each in kinds if (each is float) != isinstance(fields.get(key), list)]
        return _value(kinds[0], fields, key, path, where)
    if origin is Literal:
        return fields.choice(key, arguments)
    if origin is tuple:
        return _tuple(arguments, fields, key, path, where)
    if dataclasses.is_dataclass(hint):
        return read_record(cast(type[object], hint), fields.get(key), path, where)
    return _plain(hint, fields, key, path, where)


def _plain(hint: Any, fields: Fields, key: str, path: Path, where: str) -> object:
    if hint is bool:
        if not isinstance(fields.get(key), bool):
            raise fields.error(key, f"expected true or false, got {fields.get(key)!r}")
        return fields.get(key)
    if hint is float:
        return fields.number(key)
    if hint is int:
        return fields.integer(key)
    if hint is Path:
        return resolve_inside(path.parent, fields.text(key), path)
    if hint is str:
        return fields.text(key)
    table = fields.get(key)  # a mapping from names to three numbers
    known = list(cast(Mapping[str, object], table)) if isinstance(table, Mapping) else []
    inside = Fields(table, known, path, where)
    return {name: tuple(inside.numbers(name, 3)) for name in known}


def _tuple(arguments: tuple[Any, ...], fields: Fields, key: str, path: Path, where: str) -> object:
    if arguments[-1] is not Ellipsis:
        return tuple(fields.numbers(key, len(arguments)))
    item = arguments[0]
    if not isinstance(fields.get(key), list):
        raise fields.error(key, f"expected a list, got {fields.get(key)!r}"[:120])
    if dataclasses.is_dataclass(item):
        kind = cast(type[object], item)
        return tuple(read_record(kind, each, path, f"{where}[{i}]") for i, each in enumerate(fields.items(key)))
    return tuple(_pair(typing.get_args(item)[0], each, fields, key) for each in fields.items(key))


def _pair(kind: Any, value: object, fields: Fields, key: str) -> tuple[object, object]:
    """Two texts, or two numbers."""
    items = cast(list[object], value) if isinstance(value, list) else []
    wanted = str if kind is str else int | float
    if len(items) != 2 or not all(isinstance(each, wanted) and not isinstance(each, bool) for each in items):
        words = "pairs of names" if kind is str else "pairs of numbers"
        raise fields.error(key, f"expected {words}, got {value!r}"[:160])
    first, second = (kind(each) for each in items)
    return first, second


def toml_lines(record: object, where: str) -> list[str]:
    """The table of a record with every key that has a value, the tables in it after it."""
    plain: list[str] = []
    tables: list[str] = []
    for field in dataclasses.fields(cast(Any, record)):
        value: Any = getattr(record, field.name)
        name = _join(where, field.name)
        if dataclasses.is_dataclass(value):
            tables += ["", f"[{name}]", *toml_lines(value, name)]
        elif isinstance(value, tuple) and value and dataclasses.is_dataclass(cast(Any, value)[0]):
            for each in cast(tuple[object, ...], value):
                tables += ["", f"[[{name}]]", *toml_lines(each, name)]
        elif value is not None:
            plain.append(f"{field.name} = {toml_value(value)}")
    return [*plain, *tables]


def toml_value(value: Any) -> str:
    """A value in TOML; numbers read back to the last bit."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, Mapping):
        items = cast(Mapping[str, object], value).items()
        return "{" + ", ".join(f"{toml_value(name)} = {toml_value(each)}" for name, each in items) + "}"
    if isinstance(value, tuple | list):
        return "[" + ", ".join(toml_value(each) for each in cast(list[object], value)) + "]"
    return json.dumps(str(value), ensure_ascii=False).replace("\x7f", "\\u007f")
