# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The first look: a handful of numbers of the main method, with the other methods in small print."""

from collections.abc import Mapping
from dataclasses import dataclass

from fairlead.evaluate.catalogue import METRICS
from fairlead.evaluate.evaluation import Evaluation
from fairlead.evaluate.metric import Mark, Metric
from fairlead.evaluate.units import LengthUnit, length_unit, number

N_TILES = 6
_FIRST = (
    *("rotation_deg", "translation_percent", "landmarks_m", "pose_nees", "coverage_percent", "update_p99_ms"),
    *("reprojection_px", "noise_factor", "outlier_percent", "landmark_shift_m", "prior_factor", "update_p50_ms"),
)
"""Metrics by how much a reader wants them; the first six that the run has are shown."""
_GIVEN = "landmarks_before_m"
_OURS = ("map", "refine")


@dataclass(frozen=True, kw_only=True)
class Tile:
    """One large number."""

    label: str
    text: str
    unit: str
    mark: Mark | None
    before: str
    """The given model's number where there is one to compare with, else empty."""
    others: tuple[tuple[str, str], ...]
    """(method, number) of the other methods."""


def main_method(evaluations: Mapping[str, Evaluation]) -> str:
    """The method that the report is about: ours if it is there, else the first. Raises ValueError for none."""
    if not evaluations:
        raise ValueError("report: expected at least one run, got none")
    return next((name for name in _OURS if name in evaluations), next(iter(evaluations)))


def tiles(evaluations: Mapping[str, Evaluation]) -> tuple[Tile, ...]:
    """At most N_TILES tiles."""
    by_key = {metric.key: metric for metric in METRICS}
    unit = length_unit(evaluations.values())
    built = (_tile(by_key[key], evaluations, by_key[_GIVEN], unit) for key in _FIRST)
    return tuple(tile for tile in built if tile is not None)[:N_TILES]


def _tile(metric: Metric, evaluations: Mapping[str, Evaluation], given: Metric, unit: LengthUnit) -> Tile | None:
    main = main_method(evaluations)
    reading = metric.read(evaluations[main])
    if reading is None:
        return None
    others = [(name, metric.read(each)) for name, each in evaluations.items() if name != main]
    before = given.read(evaluations[main]) if metric.key == "landmarks_m" else None

    def text(value: float) -> str:
        return number(unit.scaled(value, metric.unit))

    return Tile(
        label=metric.label.removesuffix(", mean").removesuffix(", raw").removesuffix(" / dof"),
        text=text(reading.value),
        unit="1 is right" if metric.better == "one" else unit.renamed(metric.unit),
        mark=reading.mark,
        before="" if before is None else text(before.value),
        others=tuple((name, text(other.value)) for name, other in others if other is not None),
    )
