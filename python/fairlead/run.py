# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The meeting point: source -> detector -> estimator -> sinks."""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from fairlead.config import EvaluateConfig, InputConfig, RefineConfig, TrackConfig, UsageError
from fairlead.inputs import Seen, follow, let_go, open_camera, open_views, timed_views, told_correlation
from fairlead.io.attitudes import read_attitudes
from fairlead.io.errors import InputError
from fairlead.io.options import load_options
from fairlead.io.poses import read_truth
from fairlead.io.ranges import read_ranges
from fairlead.io.run_record import RunRecord, input_file
from fairlead.io.target import load_target
from fairlead.io.timing import Timing
from fairlead.outputs import check_outputs, open_outputs
from fairlead.progress import ProgressFactory, silent
from fairlead.sinks.run_folder import WRITTEN, RunFolder
from fairlead.sinks.sink import Outcome
from fairlead.sources.readings import SensorReadings
from fairlead.sources.source import ViewSource
from fairlead.sources.video import without_password
from fairlead.tracker import Refinement, Tracker, TrackerOptions
from fairlead.tracker import refine as refine_batch
from fairlead.types import Camera, PoseEstimator, Target, View

MIN_LANDMARKS = 4
"""Fewer do not determine a pose."""


@dataclass(frozen=True, kw_only=True)
class RunSummary:
    """What a run came to."""

    output: Path
    frames: int
    frames_with_pose: int
    frames_in_doubt: int
    """With a pose, but the data contradict what was told."""
    report: Path | None
    """Where truth was given."""
    unjudged: str | None = None
    """Why there is no report although truth was given, in one line."""
    observations_dropped: int = 0
    """That the estimator could not use, `Estimate.n_dropped`."""
    range_bias: tuple[float, float] | None = None
    """What the range finder always reads too much and its standard deviation [m], where it was looked for."""

    @property
    def coverage(self) -> float:
        """Share of the frames that got a pose [-]."""
        return self.frames_with_pose / self.frames


def track(config: TrackConfig, progress: ProgressFactory = silent) -> RunSummary:
    """Update an estimator frame by frame; every file is written as the frames come.

    Raises InputError or UsageError before any output for files that cannot be used; InputError later for a frame that
    cannot be read, and what was computed until then stays.
    """
    target, camera = _load(config)
    source = open_views(config, target, camera)
    readings = sensor_readings(config, target)
    options = told_options(config, source, readings)
    estimator = make_estimator(config, options, target, camera)
    views_seen = timed_views(source, config.source)
    record = _record("track", config, options if config.method == "map" else None)
    with RunFolder(config.output, record, target, camera) as folder:
        folder.open_sinks(estimator)
        for sink in open_outputs(config, target, camera, estimator):
            folder.add(sink)
        try:
            with progress("track", lambda: source.count() or None) as advance:
                for seen in views_seen:
                    start_s = time.perf_counter()
                    if isinstance(estimator, Tracker):
                        readings.tell(estimator, seen.view)
                    estimate = estimator.update(seen.view)
                    update_ms = 1e3 * (time.perf_counter() - start_s)
                    follow(source, estimate)
                    outcome = Outcome(estimate=estimate, view=seen.view, image=seen.image)
                    folder.write_outcome(outcome, _timing(seen, update_ms))
                    advance(source.work(seen.view))
        finally:
            folder.count_dropped(let_go(source))
    summary = _finish(config, folder)
    return _with_bias(summary, estimator.range_bias) if isinstance(estimator, Tracker) else summary


def _with_bias(summary: RunSummary, bias: tuple[float, float]) -> RunSummary:
    """The summary with what the range finder always reads too much, where it was looked for."""
    return replace(summary, range_bias=bias if bias[1] > 0.0 else None)


def refine(config: RefineConfig, progress: ProgressFactory = silent) -> RunSummary:
    """Solve all views of a flight at once. Errors as `track`."""
    target, camera = _load(config)
    source = open_views(config, target, camera)
    readings = sensor_readings(config, target)
    options = told_options(config, source, readings)
    views_seen = timed_views(source, config.source)
    with RunFolder(config.output, _record("refine", config, options), target, camera) as folder:
        folder.open_sinks(None)
        views: list[View] = []
        timings: list[Timing] = []
        with progress("read", source.count) as advance:
            for seen in views_seen:
                folder.write_view(seen.view)
                views.append(seen.view)
                timings.append(_timing(seen, float("nan")))
                advance(source.work(seen.view))
        batch = partial(refine_batch, views, target, camera, options)
        refinement = _solve(config, partial(batch, ranges=readings.ranges, attitudes=readings.attitudes))
        for estimate, timing in zip(refinement.estimates, timings, strict=True):
            folder.write(estimate, timing)
        folder.save_model(refinement.model)
    summary = _finish(config, folder)
    return _with_bias(summary, (refinement.range_bias_m, refinement.range_bias_sigma_m))


def _solve(config: RefineConfig, batch: Callable[[], Refinement]) -> Refinement:
    """The batch, in a thread of its own, so that a signal need not wait for its end."""
    answers: list[Refinement | Exception] = []

    def solve() -> None:
        try:
            answers.append(batch())
        except Exception as error:  # raised again below, in the thread that asked
            answers.append(error)

    thread = threading.Thread(target=solve, daemon=True)
    thread.start()
    thread.join()
    answer = answers[0]
    if isinstance(answer, ValueError):
        raise InputError(config.target, str(answer)) from answer
    if isinstance(answer, Exception):
        raise answer
    return answer


def evaluate(config: EvaluateConfig) -> Path:
    """Compare a run with the truth; returns the report."""
    from fairlead.evaluate import evaluate_run

    if not config.run.is_dir():
        raise InputError(config.run, "expected a folder written by track or refine")
    return evaluate_run(config.run, config.truth, target_true=config.target_true, output=config.output)


def sensor_readings(config: InputConfig, target: Target) -> SensorReadings:
    """What other sensors said. Raises InputError, UsageError."""
    method = config.method if isinstance(config, TrackConfig) else "map"
    for path, name in ((config.range, "--range"), (config.attitude, "--attitude")):
        if path is not None and method != "map":
            raise UsageError(f"{name}: method {method} has no use for it")
    readings = SensorReadings(
        ranges=[] if config.range is None else read_ranges(config.range),
        attitudes=[] if config.attitude is None else read_attitudes(config.attitude),
    )
    for reading in readings.ranges:
        if reading.landmark is not None and reading.landmark not in target.landmarks:
            raise InputError(config.range or "", f"the target has no landmark {reading.landmark!r}")
    return readings


def make_estimator(config: TrackConfig, options: TrackerOptions, target: Target, camera: Camera) -> PoseEstimator:
    """The estimator of a method. Raises InputError for a target or options that it cannot use."""
    try:
        return _estimator(config, options, target, camera)
    except (InputError, UsageError):
        raise
    except ValueError as error:
        raise InputError(config.target, str(error)) from error


def _estimator(config: TrackConfig, options: TrackerOptions, target: Target, camera: Camera) -> PoseEstimator:
    if config.method == "map":
        return Tracker(target, camera, options)
    if config.options is not None:
        raise UsageError(f"--options: method {config.method} has none")
    if config.method == "window":
        from fairlead.baselines.free_window import WindowTracker

        return WindowTracker(target, camera)
    from fairlead.baselines.epnp import EpnpTracker

    return EpnpTracker(target, camera)


def told_options(config: InputConfig, source: ViewSource, readings: SensorReadings) -> TrackerOptions:
    """Those of the file, what the detector says of its errors, and what the readings need."""
    options = told_correlation(source, tracker_options(config.options))
    if any(reading.landmark is None for reading in readings.ranges):
        options = replace(options, range_to_origin=True)
    if config.range_bias_sigma_m > 0.0:
        options = replace(options, range_bias_sigma_m=config.range_bias_sigma_m)
    return options


def tracker_options(path: Path | None) -> TrackerOptions:
    """The options of a file, or the defaults. Raises InputError, which names that file."""
    if path is None:
        return TrackerOptions()
    options = load_options(path, TrackerOptions())
    try:
        options.check()
    except ValueError as error:
        raise InputError(path, str(error)) from error
    return options


def _load(config: InputConfig) -> tuple[Target, Camera]:
    """Target and camera; refuses to write over anything that is read."""
    paths = _input_paths(config)
    for path in paths.values():
        if path.name in WRITTEN and path.resolve().parent == config.output.resolve():
            raise UsageError(f"--output: {config.output} would write over the input {path}")
    if isinstance(config, TrackConfig):
        check_outputs(config, list(paths.values()))
    elif isinstance(config.source, str):
        raise UsageError(f"{config.source} has no end: use track")
    if config.truth is not None and not read_truth(config.truth):  # found out now, not at the end of a long run
        raise InputError(config.truth, "holds no poses")
    target = load_target(config.target)
    if len(target.landmarks) < MIN_LANDMARKS:
        raise InputError(config.target, f"expected at least {MIN_LANDMARKS} landmarks, got {len(target.landmarks)}")
    return target, open_camera(config)


def _timing(seen: Seen, update_ms: float) -> Timing:
    view = seen.view
    times = {"read_ms": seen.read_ms, "detect_ms": seen.detect_ms, "update_ms": update_ms}
    return Timing(frame=view.frame, stamp_ns=view.stamp_ns, **times)


def _input_paths(config: InputConfig) -> dict[str, Path]:
    """Every file that was named, by its role."""
    paths = {"target": config.target}
    more = {"camera": config.camera, "options": config.options, "truth": config.truth}
    more |= {"range": config.range, "attitude": config.attitude}
    if config.detector is not None and config.detector.endswith(".onnx"):
        more["detector"] = Path(config.detector)
    if isinstance(config, TrackConfig):
        more["mount"] = config.mount
    if isinstance(config.source, Path):
        paths = {"source": config.source} | paths
    return paths | {role: path for role, path in more.items() if path is not None}


def _record(command: str, config: InputConfig, options: TrackerOptions | None) -> RunRecord:
    inputs = tuple(input_file(role, path) for role, path in _input_paths(config).items())
    seed = None if options is None else options.seed
    if isinstance(config.source, str):
        config = replace(config, source=without_password(config.source))
    return RunRecord(command=command, state="running", options=config, inputs=inputs, estimator=options, seed=seed)


def _finish(config: InputConfig, folder: RunFolder) -> RunSummary:
    report = unjudged = None
    if config.truth is not None:
        try:
            report = evaluate(EvaluateConfig(run=config.output, truth=config.truth))
        except InputError as error:  # the run is done, and stays
            unjudged = str(error)
    return RunSummary(
        output=config.output,
        frames=folder.record.frames,
        frames_with_pose=folder.record.frames_with_pose,
        frames_in_doubt=folder.frames_in_doubt,
        report=report,
        unjudged=unjudged,
        observations_dropped=folder.observations_dropped,
    )
