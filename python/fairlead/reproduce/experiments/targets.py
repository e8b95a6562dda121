# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Does ours keep what it promises on a sequence: near the bound, never worse than EPnP or the published window."""

from collections.abc import Sequence as Rows

import numpy as np

from fairlead.reproduce.content import Cell, Column, Row, Table
from fairlead.reproduce.context import Context, Seeds
from fairlead.reproduce.detections import Network
from fairlead.reproduce.measured import Measured
from fairlead.reproduce.methods import BATCH, EPNP, LABELS, ONLINE, TOLD, WINDOW
from fairlead.reproduce.scores import Paired, on_common_frames, paired, rms_over, score
from fairlead.reproduce.sequences import Sequence

BOUND_LIMIT = 1.3
"""Root mean squares at most so many times the bound's."""
ERRORS = (("rotation", "deg"), ("translation", "m"), ("model", "m"))
OTHERS = ((EPNP, "EPnP"), (WINDOW, "window"))


def _columns() -> tuple[Column, ...]:
    columns = [
        Column(key="sequence", title="sequence"),
        Column(key="network", title="network"),
        Column(key="label", title="method"),
    ]
    for name, _ in ERRORS:
        columns.append(Column(key=f"{name}_over_bound", title=f"{name}: rms / bound", mark=f"{name}_bound_missed"))
    for name, _ in ERRORS:
        columns.append(Column(key=f"{name}_over_alike", title=f"{name}: the same, errors that stay"))
    for other, short in OTHERS:
        for name, _ in ERRORS:
            key = f"{name}_vs_{other}"
            columns.append(Column(key=key, title=f"{name} / {short}'s", interval=True, mark=f"{key}_missed"))
        columns.append(Column(key=f"worse_{other}", title=f"seeds worse than {short} [%]", percent=True, digits=2))
    return (*columns, Column(key="reason", title="why missed"))


_NOTE = (
    f"Targets: rms at most {BOUND_LIMIT} times the bound with the network's measured covariance (online: the bound "
    "of what was seen so far); ratio of the means to EPnP's and the window's, on the frames where these have a pose, "
    "not above 1 by its paired 95 % interval. 'Errors that stay': the bound with the measured likeness of the "
    "network's errors from frame to frame. Seeds worse: in translation."
)


def target_table(rows: Rows[Row]) -> Table:
    """All sequences and networks."""
    return Table(name="table3_targets", title="Targets", columns=_columns(), rows=rows, note=_NOTE)


def target_row(context: Context, sequence: Sequence, network: Network, method: str) -> Row:
    """How ours stands to the bound and to the others."""
    seeds = context.runs(sequence, network)
    row: dict[str, Cell] = {"sequence": sequence.name, "network": network.label, "method": method}
    row |= {"label": LABELS[method]} | _bound_cells(context, sequence, network, seeds, method)
    for other, _ in OTHERS:
        row |= _against(seeds, method, other)
    measured = context.measured(sequence, network)
    return row | {"reason": "" if measured is None else _reason(row, measured)}


def _bound_cells(context: Context, sequence: Sequence, network: Network, seeds: Seeds, method: str) -> dict[str, Cell]:
    bounds = context.bounds(sequence, network)
    if bounds is None:
        return {}
    scores = [score(each[method], flight) for each, flight in zip(seeds.tracks, seeds.flights, strict=True)]
    floors = (bounds.causal, bounds.causal_alike) if method in (ONLINE, TOLD[ONLINE]) else (bounds.white, bounds.alike)
    cells: dict[str, Cell] = {}
    for kind, floor in zip(("bound", "alike"), floors, strict=True):
        least = {"rotation": _rms(floor.rotation_rms_deg), "translation": _rms(floor.translation_rms_m)}
        least["model"] = floor.model_rms_m
        for name, unit in ERRORS:
            cells[f"{name}_over_{kind}"] = rms_over(scores, f"{name}_rms_{unit}") / least[name]
    for name, _ in ERRORS:
        ratio = cells[f"{name}_over_bound"]
        cells[f"{name}_bound_missed"] = not (isinstance(ratio, float) and ratio <= BOUND_LIMIT)
    return cells


def _against(seeds: Seeds, method: str, other: str) -> dict[str, Cell]:
    """Paired over the seeds where the other has a pose in some frame."""
    mine: dict[str, list[float]] = {name: [] for name, _ in ERRORS}
    theirs: dict[str, list[float]] = {name: [] for name, _ in ERRORS}
    for tracks, flight in zip(seeds.tracks, seeds.flights, strict=True):
        a, b = on_common_frames(tracks[method], tracks[other], flight)
        for name, unit in ERRORS:
            mine[name].append(a[f"{name}_{unit}"])
            theirs[name].append(b[f"{name}_{unit}"])
    cells: dict[str, Cell] = {}
    for name, _ in ERRORS:
        pair: Paired = paired(mine[name], theirs[name])
        key = f"{name}_vs_{other}"
        cells[key], cells[f"{key}_low95"], cells[f"{key}_high95"] = pair.ratio, pair.low, pair.high
        cells[f"{key}_missed"] = pair.is_worse and not np.isnan(pair.ratio)
        cells[f"{name}_worse_{other}"] = pair.worse
    cells[f"worse_{other}"] = cells[f"translation_worse_{other}"]
    return cells


def _reason(row: Row, measured: Measured) -> str:
    """What of the detections explains a missed target; nothing where none is missed."""
    if not any(value is True for key, value in row.items() if key.endswith("_missed")):
        return ""
    reasons: list[str] = []
    if measured.inefficiency > 2.0:
        within = all(_number(row.get(f"{name}_over_alike")) <= BOUND_LIMIT for name, _ in ERRORS)
        end = "with that, the bound is kept" if within else _END.get(str(row["method"]), "which it is not told")
        reasons.append(f"errors stay: {measured.inefficiency:.0f} frames say as much as one, {end}")
    if measured.outliers > 0.01:
        reasons.append(f"{100.0 * measured.outliers:.1f} % outliers, which the bound does not have")
    if not 0.5 <= measured.factor <= 2.0:
        reasons.append(f"told variances are off by a factor of {measured.factor:.2g}")
    return "; ".join(reasons) or "not found"


_END = {TOLD[ONLINE]: "which it is told as a time", BATCH: "which the batch cannot be told"}


def _number(value: Cell) -> float:
    return float(value) if isinstance(value, int | float) else float("inf")


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt((values**2).mean()))
