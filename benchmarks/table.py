# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A table of results, as Markdown."""

from collections.abc import Iterable, Sequence
from pathlib import Path


def write_table(path: Path, headings: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Write it, folder and all, and print it."""
    lines = ["| " + " | ".join(cells) + " |" for cells in (headings, *rows)]
    table = "\n".join([lines[0], "|---" * len(headings) + "|", *lines[1:]]) + "\n"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(table, encoding="utf-8")
    print(table)
