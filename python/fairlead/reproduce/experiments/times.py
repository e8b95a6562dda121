# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Table 5: milliseconds per frame."""

import numpy as np

from fairlead.reproduce import published
from fairlead.reproduce.content import Cell, Column, Row, Section, Table
from fairlead.reproduce.context import Context
from fairlead.reproduce.detections import Network
from fairlead.reproduce.experiments.shared import NO_SEQUENCES, run_facts, undetected
from fairlead.reproduce.methods import BATCH, EPNP, LABELS, ONLINE, WINDOW

_COLUMNS = (
    Column(key="network", title="network"),
    Column(key="label", title="method"),
    Column(key="detect_ms", title="read and detect [ms]"),
    Column(key="update_ms", title="estimate, mean [ms]"),
    Column(key="update_p99_ms", title="estimate, 99 % [ms]"),
    Column(key="total_ms", title="together [ms]"),
    Column(key="where", title="measured"),
)


def times(context: Context) -> Section:
    """Ours on this machine; theirs as published."""
    rows: list[Row] = [
        {"network": "PP-TinyPose", "label": "EPnP", "total_ms": published.TINYPOSE_EPNP_MS, "where": published.THEIRS},
        {"network": "RTMPose", "label": "EPnP", "total_ms": published.RTMPOSE_EPNP_MS, "where": _REAL},
        {"network": "RTMPose", "label": "their method", "total_ms": published.METHOD_MS, "where": published.THEIRS},
        {"network": "RTMPose", "label": "their method", "total_ms": published.METHOD_REAL_MS, "where": _REAL},
    ]
    for network in context.networks:
        rows += [_row(context, network, method) for method in (EPNP, WINDOW, ONLINE, BATCH)]
    note = (
        "Wall time on the machine named above, which was busy with other things, one thread per network; images are "
        "decoded and cropped inside 'read and detect'. Batch: its time divided by the number of frames."
    )
    return Section(
        name="times",
        title="Table 5: time per frame",
        published=f"{published.TINYPOSE_EPNP_MS} ms for PP-TinyPose-EPnP and {published.METHOD_MS} ms for the method, "
        "on hardware that we do not have: theirs and ours do not compare.",
        tables=[Table(name="table5", title="Table 5: milliseconds per frame", columns=_COLUMNS, rows=rows, note=note)],
        missing=undetected(context) if context.sequences else [NO_SEQUENCES],
        facts=run_facts(context),
    )


_REAL = f"{published.THEIRS}, real sequences"


def _row(context: Context, network: Network, method: str) -> Row:
    detect: list[np.ndarray] = []
    update: list[np.ndarray] = []
    for sequence in context.sequences:
        found = context.detections(sequence, network)
        if found is not None:
            detect.append(found.detect_ms)
            update += [tracks[method].update_ms for tracks in context.runs(sequence, network).tracks]
    row: dict[str, Cell] = {"network": network.label, "label": LABELS[method], "where": "here"}
    if update:
        values = np.concatenate(update)
        row["update_ms"], row["update_p99_ms"] = float(np.mean(values)), float(np.quantile(values, 0.99))
        looked = np.concatenate(detect)
        if looked.size:
            row["detect_ms"] = float(np.mean(looked))
            row["total_ms"] = float(np.mean(looked) + np.mean(values))
    return row
