# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Methods side by side: the rows of the report, and errors.csv."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import get_args

import numpy as np

from fairlead.evaluate.catalogue import METRICS
from fairlead.evaluate.evaluation import AgainstTruth, Evaluation
from fairlead.evaluate.metric import Better, Group, Mark, Metric, Reading
from fairlead.evaluate.units import LengthUnit, length_unit, number
from fairlead.io.csv_lines import CsvWriter


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One number of one method, as it is printed."""

    text: str
    details: tuple[str, ...]
    """Small print, piece by piece."""
    mark: Mark | None
    best: bool
    """The best of several methods."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One metric of all methods; None where a method does not have it."""

    key: str
    label: str
    unit: str
    cells: tuple[Cell | None, ...]


@dataclass(frozen=True, kw_only=True)
class Table:
    """The rows of one group."""

    key: Group
    rows: tuple[Row, ...]


def tables(evaluations: Mapping[str, Evaluation]) -> tuple[Table, ...]:
    """All groups that at least one run has numbers for; columns in the order of `evaluations`."""
    unit = length_unit(evaluations.values())
    built: list[Table] = []
    for key in get_args(Group):
        rows = [_row(metric, list(evaluations.values()), unit) for metric in METRICS if metric.group == key]
        present = tuple(row for row in rows if any(cell is not None for cell in row.cells))
        if present:
            built.append(Table(key=key, rows=present))
    return tuple(built)


def _row(metric: Metric, evaluations: Sequence[Evaluation], unit: LengthUnit) -> Row:
    readings = [metric.read(evaluation) for evaluation in evaluations]
    best = _best(metric.better, readings)
    cells = [
        None if reading is None else _cell(metric, reading, unit, best=reading.value == best) for reading in readings
    ]
    return Row(key=metric.key, label=metric.label, unit=unit.renamed(metric.unit), cells=tuple(cells))


def _cell(metric: Metric, reading: Reading, unit: LengthUnit, *, best: bool) -> Cell:
    spread = [f"{name} {number(unit.scaled(value, metric.unit))}" for name, value in reading.spread]
    details = (*spread, *filter(None, reading.note.split("; ")))
    return Cell(text=number(unit.scaled(reading.value, metric.unit)), details=details, mark=reading.mark, best=best)


def _best(better: Better, readings: Sequence[Reading | None]) -> float | None:
    """The best value where methods differ; None where there is nothing to compare."""
    values = [reading.value for reading in readings if reading is not None and not math.isnan(reading.value)]
    if better == "neither" or len(set(values)) < 2:
        return None
    if better == "one":
        return min(values, key=lambda value: abs(math.log(value)) if value > 0.0 else math.inf)
    return min(values) if better == "lower" else max(values)


_POSE_COLUMNS = ("rotation_deg", "translation_m", "position_m")
_ERROR_COLUMNS = (
    *("frame", "stamp_ns", "failed", "range_m", *_POSE_COLUMNS),
    *("rotation_sim3_deg", "translation_sim3_m", "position_sim3_m", "nees_per_dof", "reprojection_rms_px"),
)


def write_errors(path: Path, evaluation: Evaluation) -> None:
    """errors.csv: one line per frame of the run; cells without a number are empty."""
    run, truth, image = evaluation.run, evaluation.truth, evaluation.reprojection
    judged = {} if truth is None else {int(row): k for k, row in enumerate(truth.rows)}
    with CsvWriter(path, _ERROR_COLUMNS) as writer:
        for row in range(len(run.frames)):
            k = judged.get(row)
            failed, values = "", [math.nan] * 8
            if truth is not None and k is not None:
                failed, values = str(int(truth.raw.failed[k])), _errors_of(truth, k)
            values.append(math.nan if image is None else float(image.per_frame_px[row]))
            cells: list[object] = [value if math.isfinite(value) else "" for value in values]
            writer.write_rows([[int(run.frames[row]), int(run.stamps_ns[row]), failed, *cells]])


def _errors_of(truth: AgainstTruth, k: int) -> list[float]:
    """The numbers of one judged frame in the order of the columns."""
    nees = truth.consistency.nees
    values = [float(np.linalg.norm(truth.T_true[k, :3, 3]))]
    for errors in (truth.raw, truth.sim3):
        series = () if errors is None else (errors.rotation_deg, errors.translation_m, errors.position_m)
        values += [float(each.values[k]) for each in series] or [math.nan] * 3
    return [*values, math.nan if nees is None else float(nees.values[k])]
