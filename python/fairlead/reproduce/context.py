# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What every experiment may ask for: sequences, networks, detections, runs; each made once and kept."""

from dataclasses import dataclass, field
from pathlib import Path

from fairlead.config import ReproduceConfig
from fairlead.io.shipped import shipped_data
from fairlead.io.target import load_target
from fairlead.progress import ProgressFactory
from fairlead.reproduce.bounds import Bound, bound, causal_bound
from fairlead.reproduce.detections import Detections, Network, detect, networks_of
from fairlead.reproduce.measured import Measured, Observed, measure, observe, shared_error
from fairlead.reproduce.methods import Flight, Track
from fairlead.reproduce.sequences import ORDER, Sequence, find_sequences
from fairlead.reproduce.work import flight_of, job_of, run_job
from fairlead.types import Target

Pair = tuple[str, str]
"""Names of a sequence and a network."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Bounds:
    """Of one sequence and network: errors of single frames taken as independent, and with their measured likeness."""

    white: Bound
    alike: Bound
    causal: Bound
    causal_alike: Bound


@dataclass(frozen=True, kw_only=True, eq=False)
class Seeds:
    """All seeds of one sequence and network."""

    flights: tuple[Flight, ...]
    tracks: tuple[dict[str, Track], ...]


@dataclass(kw_only=True)
class Context:
    """Made by the command; experiments only read it."""

    config: ReproduceConfig
    progress: ProgressFactory
    target: Target = field(init=False)
    """Of sequences that have none of their own."""
    sequences: list[Sequence] = field(init=False)
    networks: list[Network] = field(init=False)
    _detections: dict[Pair, Detections | None] = field(default_factory=dict)
    _observed: dict[Pair, Observed] = field(default_factory=dict)
    _seeds: dict[Pair, Seeds] = field(default_factory=dict)
    _bounds: dict[Pair, Bounds] = field(default_factory=dict)

    def __post_init__(self) -> None:
        folders = self.config.sequences or _shipped_clips()
        self.target = load_target(self.target_path)
        self.sequences = find_sequences(folders, self.target_path, self.cache / "tables")
        files = self.config.networks or tuple(sorted(shipped_data("frigate").glob("*.onnx")))
        self.networks = networks_of(files, self.sequences)

    @property
    def target_path(self) -> Path:
        """Of sequences that have no target.toml of their own."""
        return self.config.target or shipped_data("frigate") / "target.toml"

    @property
    def cache(self) -> Path:
        """Where what can be made again is kept."""
        return self.config.cache or self.config.output / "cache"

    @property
    def seeds(self) -> int:
        """Told models per sequence."""
        return self.config.seeds if self.config.seeds is not None else (3 if self.config.quick else 20)

    @property
    def study_runs(self) -> int:
        """Runs per setting of the simulated studies."""
        return self.config.study_runs if self.config.study_runs is not None else (50 if self.config.quick else 1000)

    def pairs(self) -> list[tuple[Sequence, Network]]:
        """Every sequence with every network that has something to say of it."""
        return [(s, n) for s in self.sequences for n in self.networks if self.detections(s, n) is not None]

    def best_network(self, sequence: Sequence) -> Network | None:
        """The first in the order of networks that looked at the sequence: the default one."""
        return next((n for n in self.networks if self.detections(sequence, n) is not None), None)

    def detections(self, sequence: Sequence, network: Network) -> Detections | None:
        """What a network finds in a sequence."""
        key = (sequence.name, network.name)
        if key not in self._detections:
            self._detections[key] = detect(sequence, network, self.cache / "detections", self.progress)
        return self._detections[key]

    def observed(self, sequence: Sequence, network: Network) -> Observed:
        """The same beside the truth; an assertion fails where there is nothing."""
        key = (sequence.name, network.name)
        if key not in self._observed:
            found = self.detections(sequence, network)
            assert found is not None
            self._observed[key] = observe(sequence, found.views)
        return self._observed[key]

    def measured(self, sequence: Sequence, network: Network) -> Measured | None:
        """How wrong it is."""
        return measure(self.observed(sequence, network))

    def design_effect(self, sequence: Sequence, network: Network) -> float:
        """By how much errors that landmarks share widen the pose of a view; 1 where too little was observed."""
        return shared_error(sequence, self.observed(sequence, network))

    def runs(self, sequence: Sequence, network: Network) -> Seeds:
        """All methods with all told models."""
        key = (sequence.name, network.name)
        if key not in self._seeds:
            found = self.detections(sequence, network)
            assert found is not None
            observed = self.observed(sequence, network)
            jobs = [job_of(sequence, found, observed, seed) for seed in range(self.seeds)]
            tracks: list[dict[str, Track]] = []
            with self.progress(f"{sequence.name}, {network.name}", lambda: len(jobs)) as advance:
                for job in jobs:
                    tracks.append(run_job(job, self.cache / "runs"))
                    advance(1)
            self._seeds[key] = Seeds(flights=tuple(job.flight for job in jobs), tracks=tuple(tracks))
        return self._seeds[key]

    def bounds(self, sequence: Sequence, network: Network) -> Bounds | None:
        """With the measured covariance; None where nothing was measured or some view alone determines no pose."""
        key = (sequence.name, network.name)
        if key not in self._bounds:
            measured = self.measured(sequence, network)
            found = self.detections(sequence, network)
            if measured is None or found is None:
                return None
            flight = flight_of(sequence, found.views, self.observed(sequence, network), 0)
            f, c, d = measured.factor, measured.inefficiency, self.design_effect(sequence, network)
            self._bounds[key] = Bounds(
                white=bound(flight, f),
                alike=bound(flight, f, c, d),
                causal=causal_bound(flight, f),
                causal_alike=causal_bound(flight, f, c, d),
            )
        return self._bounds[key]


def _shipped_clips() -> tuple[Path, ...]:
    """Those of the published flights."""
    try:
        return tuple(shipped_data("clips") / name for name in ORDER)
    except FileNotFoundError:
        return ()
