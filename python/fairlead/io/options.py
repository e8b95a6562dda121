# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""An option file (TOML) -> a frozen dataclass of options; an unknown key is an error that names the nearest one."""

import dataclasses
from pathlib import Path
from typing import Any, TypeVar, cast

from fairlead.io.documents import read_toml
from fairlead.io.errors import InputError
from fairlead.io.fields import Fields

Options = TypeVar("Options")


def load_options(path: Path | str, defaults: Options) -> Options:
    """`defaults` with the values of the file, each of the type of its default. Raises InputError (file, key)."""
    path = Path(path)
    instance = cast(Any, defaults)
    known = {field.name: getattr(instance, field.name) for field in dataclasses.fields(instance)}
    table = read_toml(path)
    fields = Fields(table, known, path)
    values = {key: _value(fields, key, known[key]) for key in table}
    try:
        return cast(Options, dataclasses.replace(instance, **values))
    except (ValueError, TypeError) as error:
        raise InputError(path, str(error)) from error


def _value(fields: Fields, key: str, default: object) -> object:
    value = fields.get(key)
    if isinstance(default, bool):
        if not isinstance(value, bool):
            raise fields.error(key, f"expected true or false, got {value!r}")
        return value
    if isinstance(default, int):
        return fields.integer(key)
    if isinstance(default, float):
        return fields.number(key)
    return fields.text(key)
