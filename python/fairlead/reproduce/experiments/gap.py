# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What keeps ours from the bound: the network's errors replaced by others, one property after the other."""

from collections.abc import Sequence as Rows

import numpy as np

from fairlead.progress import Progress
from fairlead.reproduce.content import Cell, Column, Picture, Row, Section, Table
from fairlead.reproduce.context import Bounds, Context
from fairlead.reproduce.detections import Network
from fairlead.reproduce.experiments.shared import NO_SEQUENCES, run_facts
from fairlead.reproduce.figures.gap import draw_gap
from fairlead.reproduce.methods import BATCH, LABELS, ONLINE, OURS, Flight, Track
from fairlead.reproduce.replaced import KINDS, REAL, Errors, replaced
from fairlead.reproduce.scores import over_bound, score, summarise
from fairlead.reproduce.sequences import Sequence
from fairlead.reproduce.work import Job, flight_of, run_job
from fairlead.tracker import TrackerOptions

SEEDS = 10
LATE = "late"
"""The network's errors, without the first frames of the flight."""
SKIPPED = 0.1
"""Share of the flight that these are."""
_NUMBERS = ("rotation", "translation", "model")
_COLUMNS = (
    Column(key="errors_label", title="errors of the landmarks"),
    *(
        Column(key=f"{method}_{key}", title=f"{LABELS[method].removeprefix('fairlead, ')}: {title}", digits=digits)
        for method in OURS
        for key, title, digits in (
            ("rotation", "rotation / bound", 3),
            ("translation", "translation / bound", 3),
            ("model", "model / bound", 3),
            ("pose_nees", "NEES / 6", 2),
        )
    ),
)


def gap(context: Context) -> Section:
    """Default network on every sequence."""
    rows = [
        row
        for sequence in context.sequences
        if (network := context.best_network(sequence)) is not None
        for row in gap_rows(context, sequence, network)
    ]
    means = _means(rows)
    caption = (
        "Root mean square errors over the bound for errors of the landmarks that have one property of the network's "
        "after the other; from top to bottom: what the bound takes for granted, to what there is. The line is the "
        "target, 1.3."
    )
    return Section(
        name="gap",
        title="What keeps ours from the bound",
        words=[_WORDS],
        tables=[
            Table(name="gap", title="Root mean squares over the bound", columns=_COLUMNS, rows=means, note=_NOTE),
            Table(name="gap_sequences", title="", columns=(), rows=rows),
        ]
        if rows
        else [],
        pictures=[Picture(name="gap", caption=caption, figure=draw_gap(rows))] if rows else [],
        missing=[] if rows else [NO_SEQUENCES],
        facts=run_facts(context) | {"told models per sequence": str(_seeds(context))},
    )


_WORDS = (
    "The same views, landmarks and told covariances with other errors (docs/reproduce.md section 7). The bound takes "
    "errors for Gaussian, independent and as large as measured: with such errors ours must reach it. What is lost "
    "with Gaussian errors that stay as long as the network's is lost to their staying; what is lost beyond that, to "
    "what else the network's errors are: alike in many landmarks (gone with random signs), constant over a whole "
    "flight (gone without their mean, and with it some of what is slow), wild (gone without outliers)."
)
_NOTE = (
    "Geometric means over the sequences; single ones in gap_sequences.csv. Bound: with the measured covariance, errors "
    "independent from frame to frame; online: of what was seen so far. NEES / 6: 1 is a true covariance. Last row: "
    f"without the first {100 * SKIPPED:.0f} % of the flight, in errors and bound."
)


def gap_rows(context: Context, sequence: Sequence, network: Network) -> list[dict[str, Cell]]:
    """One per kind of errors and method; nothing where there is no bound."""
    bounds = context.bounds(sequence, network)
    if bounds is None:
        return []
    rows: list[dict[str, Cell]] = []
    with context.progress(f"gap, {sequence.name}", lambda: len(KINDS) * _seeds(context)) as advance:
        for kind in KINDS:
            flights, tracks = _solved(context, sequence, network, kind, advance)
            for method in OURS:
                mine = [each[method] for each in tracks]
                head: dict[str, Cell] = {"sequence": sequence.name, "network": network.label, "method": method}
                rows.append(head | {"errors": kind.name, "label": kind.label} | _cells(mine, flights, bounds, method))
                if kind.name == REAL:
                    late = {"errors": LATE, "label": f"network's, after the first {100 * SKIPPED:.0f} %"}
                    rows.append(head | late | _cells(mine, flights, bounds, method, skipped=SKIPPED))
    return rows


def _seeds(context: Context) -> int:
    return min(SEEDS, context.seeds)


def _solved(
    context: Context, sequence: Sequence, network: Network, kind: Errors, advance: Progress
) -> tuple[list[Flight], list[dict[str, Track]]]:
    """All told models with one kind of errors; those of the network are solved already."""
    if kind.name == REAL:
        seeds = context.runs(sequence, network)
        advance(_seeds(context))
        return list(seeds.flights[: _seeds(context)]), list(seeds.tracks[: _seeds(context)])
    found, measured = context.detections(sequence, network), context.measured(sequence, network)
    assert found is not None
    assert measured is not None
    options = found.options if kind.told else TrackerOptions()
    flights: list[Flight] = []
    tracks: list[dict[str, Track]] = []
    for seed in range(_seeds(context)):
        flight = flight_of(sequence, found.views, context.observed(sequence, network), seed)
        flights.append(replaced(flight, kind, measured, seed))
        name = f"{sequence.name}/{network.name}/gap-{kind.name}-{seed:03d}"
        job = Job(flight=flights[-1], name=name, methods=OURS, options=options)
        tracks.append(run_job(job, context.cache / "runs"))
        advance(1)
    return flights, tracks


def _cells(
    tracks: Rows[Track], flights: Rows[Flight], bounds: Bounds, method: str, skipped: float = 0.0
) -> dict[str, Cell]:
    floor = bounds.causal if method == ONLINE else bounds.white
    ratios = over_bound(tracks, flights, floor, first=round(skipped * len(flights[0].T_true)))
    numbers = summarise([score(track, flight) for track, flight in zip(tracks, flights, strict=True)])
    return {**ratios, **{key: numbers[key] for key in ("pose_nees", "model_nees", "failed", "seeds")}}


def _means(rows: Rows[Row]) -> list[dict[str, Cell]]:
    """Over the sequences, both methods in a row."""
    found: list[dict[str, Cell]] = []
    for name in dict.fromkeys(row["errors"] for row in rows):
        mine = [row for row in rows if row["errors"] == name]
        cells: dict[str, Cell] = {"errors": name, "errors_label": mine[0]["label"]}
        for method in (ONLINE, BATCH):
            for key in (*_NUMBERS, "pose_nees", "model_nees"):
                values = [float(row[key] or np.nan) for row in mine if row["method"] == method]
                cells[f"{method}_{key}"] = float(np.exp(np.mean(np.log(values))))
        found.append(cells)
    return found
