# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Stage 2: one told model on one sequence with one network, by every method; kept by the hash of all that goes in."""

import dataclasses
import hashlib
import json
from collections.abc import Sequence as Names
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from fairlead.reproduce.detections import Detections
from fairlead.reproduce.measured import Observed, in_order
from fairlead.reproduce.methods import METHODS, Flight, Track, solve
from fairlead.reproduce.sequences import Sequence
from fairlead.study.recorded import core_digest
from fairlead.tracker import TrackerOptions
from fairlead.types import RangeReading, View

_FIELDS = tuple(each.name for each in dataclasses.fields(Track))


@dataclass(frozen=True, kw_only=True, eq=False)
class Job:
    """A flight to be solved, and where its answers are kept."""

    flight: Flight
    name: str
    """Such as orbit-2.0/heat-t/003."""
    methods: tuple[str, ...] = METHODS
    options: TrackerOptions = field(default_factory=TrackerOptions)


def flight_of(
    sequence: Sequence, views: Names[View], observed: Observed, seed: int, ranges: tuple[RangeReading, ...] = ()
) -> Flight:
    """The views of the frames with truth, and a told model."""
    return Flight(
        camera=sequence.camera,
        views=tuple(in_order(sequence, views)),
        observed=observed,
        told=sequence.told(seed),
        X_true=sequence.true.positions,
        T_true=sequence.T_true,
        ranges=ranges,
    )


def job_of(sequence: Sequence, detections: Detections, observed: Observed, seed: int) -> Job:
    """All methods on one seed, ours told of the network's errors what a user's would be told."""
    flight = flight_of(sequence, detections.views, observed, seed)
    name = f"{sequence.name}/{detections.network.name}/{seed:03d}"
    return Job(flight=flight, name=name, options=detections.options)


def run_job(job: Job, folder: Path) -> dict[str, Track]:
    """From the file if it is there, else solved and written; a file is whole or not there."""
    path = folder / f"{job.name}-{_key(job)}.npz"
    if path.is_file():
        return _load(path, job.methods)
    found = solve(job.flight, job.methods, job.options)
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f".{path.name}.part")
    with part.open("wb") as stream:
        arrays = {f"{name}/{field}": getattr(track, field) for name, track in found.items() for field in _FIELDS}
        np.savez(stream, **arrays)
    part.replace(path)
    return found


def _load(path: Path, methods: Names[str]) -> dict[str, Track]:
    with np.load(path, allow_pickle=False) as arrays:
        return {name: Track(**{field: arrays[f"{name}/{field}"] for field in _FIELDS}) for name in methods}


_VERSION = 3
"""Of what the methods do here in Python; the core has its own hash."""


def _key(job: Job) -> str:
    """Of the estimator, its options, what is told and what is true."""
    digest = hashlib.sha256(core_digest().encode("ascii"))
    digest.update(json.dumps([_VERSION, dataclasses.asdict(job.options), job.methods], sort_keys=True).encode("utf-8"))
    flight = job.flight
    readings = [[r.stamp_ns, r.range_m, r.sigma_m] for r in flight.ranges]
    for array in (
        flight.camera.K,
        flight.camera.distortion,
        flight.told.positions,
        flight.told.covariance,
        flight.X_true,
        flight.T_true,
        flight.observed.stamps_ns,
        flight.observed.pixels,
        flight.observed.covariances,
        np.array(readings, dtype=np.float64),
    ):
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()[:12]
