# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""One metric: where to read it, which way is better, when it is good."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from fairlead.evaluate.evaluation import Evaluation

Mark = Literal["good", "fair", "bad"]
Better = Literal["lower", "higher", "one", "neither"]
Group = Literal["frames", "pose", "aligned", "landmarks", "consistency", "image", "surface", "path", "time"]


@dataclass(frozen=True, kw_only=True)
class Reading:
    """One number of one run."""

    value: float
    spread: tuple[tuple[str, float], ...] = ()
    """More numbers of the same unit, named, for the small print."""
    note: str = ""
    """More small print."""
    mark: Mark | None = None


Read = Callable[[Evaluation], Reading | None]
"""None where the run does not have the number."""


@dataclass(frozen=True, kw_only=True)
class Metric:
    """One row of the table."""

    key: str
    """Stable: the name in benchmarks and tables of many runs."""
    group: Group
    label: str
    unit: str
    better: Better
    read: Read


def graded(value: float, good: tuple[float, float], fair: tuple[float, float], note: str = "") -> Reading:
    """Marked by the narrowest of the two intervals that holds the value, ends included."""
    mark: Mark = "good" if good[0] <= value <= good[1] else "fair" if fair[0] <= value <= fair[1] else "bad"
    return Reading(value=value, note=note, mark=mark)
