# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""File names that come from a file: they stay under the folder of that file."""

from pathlib import Path

from fairlead.io.errors import InputError


def resolve_inside(root: Path, name: str, named_by: Path) -> Path:
    """`root / name` with links followed; InputError if that leaves `root` or does not exist."""
    try:
        base = root.resolve(strict=True)
        resolved = (base / name).resolve(strict=True)
    except (OSError, RuntimeError, ValueError) as error:
        raise InputError(named_by, f"names a file that is not there: {name!r}") from error
    if not resolved.is_relative_to(base):
        raise InputError(named_by, f"names a file outside its folder: {name!r}; expected one under {base}")
    return resolved
