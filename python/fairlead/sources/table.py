# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""observations.csv or .parquet as a source of views."""

from collections.abc import Iterator
from pathlib import Path

from fairlead.io.errors import InputError
from fairlead.io.fields import nearest
from fairlead.io.observations import count_observations, read_views
from fairlead.types import View

SUFFIXES = (".csv", ".parquet")


class TableSource:
    """Views of a table, streamed; every landmark must be one of `landmarks`. Raises InputError (file, line)."""

    def __init__(self, path: Path, landmarks: tuple[str, ...]) -> None:
        self._path = path
        self._landmarks = frozenset(landmarks)

    def __iter__(self) -> Iterator[View]:
        for view in read_views(self._path):
            for name in view.landmarks:
                if name not in self._landmarks:
                    hint = nearest(name, self._landmarks)
                    raise InputError(self._path, f"frame {view.frame}: the target has no landmark {name!r}; {hint}")
            yield view

    def count(self) -> int:
        """Number of rows."""
        return count_observations(self._path)

    def work(self, view: View) -> int:
        """Rows of one view; an empty frame is a row too."""
        return max(1, len(view.landmarks))
