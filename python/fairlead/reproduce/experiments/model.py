# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Table 4: the error of the 3D model before and after."""

import numpy as np

from fairlead.reproduce import published
from fairlead.reproduce.content import Cell, Column, Row, Section, Table
from fairlead.reproduce.context import Context
from fairlead.reproduce.detections import Network
from fairlead.reproduce.experiments.shared import NO_SEQUENCES, run_facts, undetected
from fairlead.reproduce.methods import BOUND, LABELS, OURS, WINDOW, Flight
from fairlead.reproduce.scores import score, summarise
from fairlead.reproduce.sequences import Sequence
from fairlead.types import Points3

_COLUMNS = (
    Column(key="sequence", title="sequence"),
    Column(key="network", title="network"),
    Column(key="label", title="method"),
    Column(key="model_before_m", title="told model [m]"),
    Column(key="model_m", title="after [m]", interval=True),
    Column(key="gain", title="change [%]", percent=True, digits=2),
    Column(key="model_before_aligned_m", title="told, aligned [m]"),
    Column(key="model_aligned_m", title="after, aligned [m]", interval=True),
    Column(key="landmarks_worse", title="landmarks that got worse [%]", percent=True, digits=2),
    Column(key="model_nees", title="NEES / 3n", digits=2),
)


def model(context: Context) -> Section:
    """Window, online and batch on every sequence."""
    rows = [
        row
        for sequence, network in context.pairs()
        for method in (WINDOW, *OURS, BOUND)
        if (row := _row(context, sequence, network, method)) is not None
    ]
    note = (
        "Mean distance of the landmarks from the true ones at the end, raw and after the best similarity: rotation, "
        "translation and scale of a model are its prior's, images do not tell them. The bound's are root mean squares. "
        "NEES / 3n: 1 is a true covariance of the model."
    )
    return Section(
        name="model",
        title="Table 4: model error before and after",
        published=published.SEQUENCES,
        tables=[
            Table(
                name="table4",
                title="Table 4: mean error of the landmarks of the model",
                columns=_COLUMNS,
                rows=rows,
                note=note,
            )
        ],
        missing=undetected(context) if context.sequences else [NO_SEQUENCES],
        facts=run_facts(context),
    )


def _row(context: Context, sequence: Sequence, network: Network, method: str) -> Row | None:
    head: dict[str, Cell] = {"sequence": sequence.name, "network": network.label, "method": method}
    head["label"] = LABELS[method]
    if method == BOUND:
        bounds = context.bounds(sequence, network)
        return None if bounds is None else head | {"model_m": bounds.white.model_rms_m}
    seeds = context.runs(sequence, network)
    scores = [score(each[method], flight) for each, flight in zip(seeds.tracks, seeds.flights, strict=True)]
    numbers = summarise(scores)
    worse = [landmarks_worse(each[method].X, flight) for each, flight in zip(seeds.tracks, seeds.flights, strict=True)]
    gain = numbers["model_m"] / numbers["model_before_m"] - 1.0
    return head | numbers | {"gain": gain, "landmarks_worse": sum(worse) / len(worse)}


def landmarks_worse(X: Points3, flight: Flight) -> float:
    """Share of the landmarks that are farther from the truth than they were told."""
    after = np.linalg.norm(X - flight.X_true, axis=1)
    before = np.linalg.norm(flight.told.positions - flight.X_true, axis=1)
    return float((after > before).mean())
