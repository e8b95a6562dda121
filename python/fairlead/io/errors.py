# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The one error of every reader."""

from pathlib import Path


class InputError(ValueError):
    """A file is not what it should be. One line: file, line where known, what came, what was expected."""

    def __init__(self, path: Path | str, message: str, *, line: int | None = None) -> None:
        self.path = Path(path)
        self.line = line
        place = str(path) if line is None else f"{path}:{line}"
        super().__init__(one_line(f"{place}: {message}"))


def one_line(text: str, limit: int = 400) -> str:
    """Fold into one printable line of at most `limit` characters."""
    folded = " ".join(text.split())
    printable = "".join(character if character.isprintable() else "?" for character in folded)
    return printable if len(printable) <= limit else printable[: limit - 3] + "..."
