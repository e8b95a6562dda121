# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A range finder beside the camera: one reading a second to the target's origin."""

import dataclasses

import numpy as np

from fairlead.reproduce import published
from fairlead.reproduce.content import Cell, Column, Section, Table
from fairlead.reproduce.context import Context
from fairlead.reproduce.detections import Network
from fairlead.reproduce.experiments.shared import NO_SEQUENCES, run_facts
from fairlead.reproduce.methods import ONLINE
from fairlead.reproduce.scores import score, summarise
from fairlead.reproduce.sequences import Sequence
from fairlead.reproduce.work import Job, flight_of, run_job
from fairlead.types import RangeReading

SIGMA_M = 0.5
RATE_HZ = 1.0
_COLUMNS = (
    Column(key="sequence", title="sequence"),
    Column(key="network", title="network"),
    Column(key="label", title="fairlead, online"),
    Column(key="translation_m", title="translation [m]", interval=True),
    Column(key="translation_last_m", title="last 5 s [m]"),
    Column(key="rotation_deg", title="rotation [deg]"),
    Column(key="model_m", title="model [m]"),
    Column(key="pose_nees", title="NEES / 6", digits=2),
)


def ranges(context: Context) -> Section:
    """Default network on every sequence, without and with."""
    rows: list[dict[str, Cell]] = []
    for sequence in context.sequences:
        network = context.best_network(sequence)
        if network is not None:
            rows += [_row(context, sequence, network, ranged=ranged) for ranged in (False, True)]
    note = (
        f"The images are rendered; the range is the true one with a noise of {SIGMA_M:g} m (1 sigma), {RATE_HZ:g} "
        "reading a second. Of the seven directions that images leave free a range holds one, the scale."
    )
    return Section(
        name="ranges",
        title="A range finder fused",
        published=published.RANGE,
        words=["What infrared and LiDAR need beyond single ranges: docs/other-sensors.md."],
        tables=[Table(name="ranges", title="Without and with a range finder", columns=_COLUMNS, rows=rows, note=note)],
        missing=[] if rows else [NO_SEQUENCES],
        facts=run_facts(context),
    )


def _row(context: Context, sequence: Sequence, network: Network, *, ranged: bool) -> dict[str, Cell]:
    scores: list[dict[str, float]] = []
    found = context.detections(sequence, network)
    assert found is not None
    for seed in range(context.seeds):
        readings = _readings(sequence, seed) if ranged else ()
        flight = flight_of(sequence, found.views, context.observed(sequence, network), seed, readings)
        name = f"{sequence.name}/{network.name}/{'range' if ranged else 'alone'}-{seed:03d}"
        options = dataclasses.replace(found.options, range_to_origin=ranged)
        track = run_job(Job(flight=flight, name=name, methods=(ONLINE,), options=options), context.cache / "runs")[
            ONLINE
        ]
        late = flight.observed.stamps_ns >= flight.observed.stamps_ns[-1] - 5_000_000_000
        errors = np.linalg.norm(track.T_camera_target[late, :3, 3] - flight.T_true[late, :3, 3], axis=1)
        last = float(np.nanmean(errors)) if np.isfinite(errors).any() else float("nan")
        scores.append(score(track, flight) | {"translation_last_m": last})
    head: dict[str, Cell] = {"sequence": sequence.name, "network": network.label, "ranged": int(ranged)}
    return head | {"label": "camera and range" if ranged else "camera alone"} | summarise(scores)


def _readings(sequence: Sequence, seed: int) -> tuple[RangeReading, ...]:
    """With the first image of every second."""
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(20_240_904,)))
    readings: list[RangeReading] = []
    next_ns = sequence.truth[0].stamp_ns
    for pose in sequence.truth:
        if pose.stamp_ns >= next_ns:
            distance = float(np.linalg.norm(pose.T_camera_target[:3, 3])) + SIGMA_M * float(rng.standard_normal())
            readings.append(RangeReading(stamp_ns=pose.stamp_ns, range_m=distance, sigma_m=SIGMA_M))
            next_ns += round(1e9 / RATE_HZ)
    return tuple(readings)
