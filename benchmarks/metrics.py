# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Measured numbers with a direction and a tolerance, and the committed baseline that they are held against."""

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

BASELINE = Path(__file__).resolve().parent / "baseline.json"

Better = Literal["lower", "higher", "same"]


@dataclass(frozen=True, kw_only=True)
class Metric:
    """One number of one workload."""

    key: str
    """Such as accuracy/clean/s1-a90-m1/map/translation."""
    value: float
    unit: str
    better: Better
    tolerance: float
    """Relative change in the bad direction (either, for "same") that is still no regression [-]."""

    def __post_init__(self) -> None:
        if self.better not in ("lower", "higher", "same"):
            raise ValueError(f"metric {self.key}: expected better to be lower, higher or same, got {self.better!r}")
        if not (self.tolerance >= 0.0 and self.value == self.value):
            raise ValueError(f"metric {self.key}: expected a number and a tolerance >= 0, got {self}")


def complaint(measured: Metric, baseline: Metric) -> str | None:
    """Why the measured value is a regression against the baseline; None if it is not.

    The baseline's direction and tolerance decide: a change of code cannot loosen them unseen.
    """
    change = measured.value - baseline.value
    allowed = baseline.tolerance * abs(baseline.value)
    bad = {"lower": change, "higher": -change, "same": abs(change)}[baseline.better]
    if bad <= allowed:
        return None
    return f"{measured.key}: {baseline.value:.6g} -> {measured.value:.6g} {baseline.unit} (allowed {allowed:.2g})"


def compare(measured: Iterable[Metric], baseline: dict[str, Metric]) -> list[str]:
    """Regressions, numbers that are no longer measured, and numbers that have no baseline yet."""
    found = {metric.key: metric for metric in measured}
    lines = [text for key in found.keys() & baseline.keys() if (text := complaint(found[key], baseline[key]))]
    lines += [f"{key}: in the baseline, no longer measured" for key in baseline.keys() - found.keys()]
    lines += [f"{key}: measured, not in the baseline" for key in found.keys() - baseline.keys()]
    return sorted(lines)


def load_baseline(path: Path = BASELINE) -> dict[str, Metric]:
    """The committed numbers by key."""
    return {entry["key"]: Metric(**entry) for entry in json.loads(path.read_text(encoding="utf-8"))}


def save_baseline(metrics: Iterable[Metric], path: Path = BASELINE) -> None:
    """Write the numbers, one a line, sorted by key, so that a change is a readable diff."""
    entries = [json.dumps(asdict(metric)) for metric in sorted(metrics, key=lambda metric: metric.key)]
    path.write_text("[\n" + ",\n".join(entries) + "\n]\n", encoding="utf-8")
