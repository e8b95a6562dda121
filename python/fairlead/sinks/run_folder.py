# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The folder of one run: every file of it, readable up to the last frame however the run ends, docs/files.md."""

import dataclasses
import logging
import time
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType

from fairlead.io.camera import save_camera
from fairlead.io.observations import ObservationWriter
from fairlead.io.run_record import RunRecord, RunState, write_run_record
from fairlead.io.target import save_target
from fairlead.io.timing import Timing
from fairlead.sinks.csv import PoseSink, TimingSink
from fairlead.sinks.model import ModelHistorySink, ModelSink
from fairlead.sinks.sink import Outcome, OutcomeSink, Sink
from fairlead.sinks.tum import TumSink
from fairlead.types import Camera, Estimate, PoseEstimator, Target, View

_log = logging.getLogger(__name__)

WRITTEN = (
    *("run.json", "target.toml", "target.npz", "camera.yaml", "observations.csv", "poses.csv", "timing.csv"),
    *("trajectory.tum", "target_refined.toml", "target_refined.npz", "poses.parquet"),
    *("model_history.csv", "metrics.json", "errors.csv", "report.html"),
)
"""Files that a run, and its evaluation, leave in its folder."""


class RunFolder:
    """Context manager that owns the files of a run. Raises OSError where they cannot be written."""

    def __init__(self, path: Path, record: RunRecord, target: Target, camera: Camera) -> None:
        self._path = path
        self._record = record
        self._in_doubt = 0
        self._observations_dropped = 0
        self._sinks: list[Sink] = []
        self._outcome_sinks: list[OutcomeSink] = []
        self._stack = ExitStack()
        path.mkdir(parents=True, exist_ok=True)
        for name in WRITTEN[4:]:
            (path / name).unlink(missing_ok=True)
        save_target(path / "target.toml", target)
        save_camera(path / "camera.yaml", camera)
        write_run_record(path / "run.json", record)

    def open_sinks(self, estimator: PoseEstimator | None) -> None:
        """Start poses.csv, trajectory.tum, timing.csv, observations.csv; the model follows an estimator if given."""
        self._observations = ObservationWriter(self._path / "observations.csv", with_scores=True)
        self._stack.callback(self._observations.close)
        self._timing = TimingSink(self._path / "timing.csv")
        self._stack.callback(self._timing.close)
        self._add(PoseSink(self._path / "poses.csv"))
        self._add(TumSink(self._path / "trajectory.tum"))
        if estimator is not None:
            self._add(ModelHistorySink(self._path / "model_history.csv", estimator))
            self._add(ModelSink(self._path / "target_refined.toml", estimator))

    def _add(self, sink: Sink) -> None:
        self._sinks.append(sink)
        self._stack.callback(sink.close)

    def add(self, sink: OutcomeSink) -> None:
        """One more place for everything about a frame; closed with the folder."""
        self._outcome_sinks.append(sink)
        self._stack.callback(sink.close)

    def write_view(self, view: View) -> None:
        """Take what was seen in one frame."""
        self._observations.write(view)

    def write_outcome(self, outcome: Outcome, timing: Timing) -> None:
        """Take everything about one frame."""
        start_s = time.perf_counter()
        self.write_view(outcome.view)
        for sink in self._sinks:
            sink.write(outcome.estimate)
        for sink in self._outcome_sinks:
            sink.write(outcome)
        self._finish(outcome.estimate, dataclasses.replace(timing, sinks_ms=1e3 * (time.perf_counter() - start_s)))

    def write(self, estimate: Estimate, timing: Timing) -> None:
        """Take what was found in one frame whose view was written before."""
        for sink in self._sinks:
            sink.write(estimate)
        self._finish(estimate, timing)

    def _finish(self, estimate: Estimate, timing: Timing) -> None:
        self._timing.write(timing)
        self._in_doubt += estimate.in_doubt
        self._observations_dropped += estimate.n_dropped
        with_pose = self._record.frames_with_pose + estimate.ok
        self._record = dataclasses.replace(self._record, frames=self._record.frames + 1, frames_with_pose=with_pose)

    def count_dropped(self, images: int) -> None:
        """Images of a live source that were dropped because newer ones had come."""
        self._record = dataclasses.replace(self._record, frames_dropped=images)

    def save_model(self, model: Target) -> None:
        """Write target_refined.toml and .npz."""
        save_target(self._path / "target_refined.toml", model)

    @property
    def record(self) -> RunRecord:
        """What run.json says or will say."""
        return self._record

    @property
    def frames_in_doubt(self) -> int:
        """Frames with a pose in which the data contradict what was told."""
        return self._in_doubt

    @property
    def observations_dropped(self) -> int:
        """Observations that the estimator could not use."""
        return self._observations_dropped

    def __enter__(self) -> "RunFolder":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        state: RunState = "done"
        if kind is not None:
            state = "failed" if issubclass(kind, Exception) else "interrupted"
        self._record = dataclasses.replace(self._record, state=state)
        try:
            with self._stack:
                self._stack.callback(write_run_record, self._path / "run.json", self._record)
        except OSError as closing:
            if kind is None:
                raise
            _log.warning("%s: not everything could be closed: %s", self._path, closing)
