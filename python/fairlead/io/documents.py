# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""TOML and YAML documents from people: size and nesting are capped, every fault becomes one InputError."""

import tomllib
from pathlib import Path
from typing import cast

from fairlead.io.errors import InputError
from fairlead.io.fields import Table

MAX_DOCUMENT_BYTES = 16 * 1024 * 1024
"""Largest TOML, YAML or text document that is read [byte]."""


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
    from fairlead.io.yaml_loader import YamlProblem, parse_yaml

    try:
        document = parse_yaml(read_text(path))
    except YamlProblem as error:
        raise InputError(path, f"malformed YAML: {error}", line=error.line) from error
    if not isinstance(document, dict):
        raise InputError(path, f"expected a YAML mapping, got {type(document).__name__}")
    return cast(Table, document)
