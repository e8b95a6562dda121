# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The command line: arguments in, exit status out. 0 done, 1 coverage too low, 2 bad input; 130, 143 interrupted."""

import errno
import json
import os
import signal
import sys
import threading
from collections.abc import Sequence
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Annotated

from tyro.conf import subcommand

from fairlead.arguments import parse_arguments
from fairlead.config import (
    Config,
    DemoConfig,
    EvaluateConfig,
    RefineConfig,
    RenderConfig,
    ReproduceConfig,
    SimulateConfig,
    StudyConfig,
    TrackConfig,
    UsageError,
)
from fairlead.io.errors import InputError, one_line
from fairlead.target_config import AnnotateConfig, BootstrapConfig, TargetConfig
from fairlead.train.config import CalibrateConfig, ExportConfig, NetworkConfig, TrainConfig

if TYPE_CHECKING:
    from fairlead.run import RunSummary
    from fairlead.study import Replay

_DESCRIPTION = "Monocular 6D pose of a rigid target whose 3D model is only roughly known."

_Command = (
    Annotated[DemoConfig, subcommand("demo")]
    | Annotated[TrackConfig, subcommand("track")]
    | Annotated[RefineConfig, subcommand("refine")]
    | Annotated[EvaluateConfig, subcommand("evaluate")]
    | Annotated[SimulateConfig, subcommand("simulate")]
    | Annotated[RenderConfig, subcommand("render")]
    | Annotated[StudyConfig, subcommand("study")]
    | Annotated[TrainConfig, subcommand("train")]
    | Annotated[CalibrateConfig, subcommand("calibrate")]
    | Annotated[ExportConfig, subcommand("export")]
    | Annotated[ReproduceConfig, subcommand("reproduce")]
    | Annotated[AnnotateConfig, subcommand("annotate")]
    | Annotated[BootstrapConfig, subcommand("bootstrap")]
)


class Stopped(KeyboardInterrupt):
    """A signal asked for an end."""

    def __init__(self, number: int) -> None:
        self.number = number
        super().__init__(signal.Signals(number).name)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit status."""
    before = {number: signal.signal(number, _stop) for number in (signal.SIGINT, signal.SIGTERM)}
    stopped = False
    try:
        words = sys.argv[1:] if arguments is None else arguments
        if list(words) == ["--version"]:
            return _version()
        return _run(parse_arguments(_Command, words, prog="fairlead", description=_DESCRIPTION))
    except (InputError, UsageError) as error:
        return _complain(str(error), 2)
    except OSError as error:
        if error.errno is None:
            raise
        place = f"{error.filename}: " if error.filename else ""
        full = " (what was written stays readable)" if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG) else ""
        return _complain(f"{place}{error.strerror}{full}", 2)
    except Stopped as stop:
        stopped = True
        status = _complain("stopped; what was written stays readable", 128 + stop.number)
        if threading.active_count() > 1:  # a batch is still being solved, and cannot be told
            sys.stderr.flush()
            os._exit(status)
        return status
    finally:
        for number, handler in before.items() if not stopped else ():
            signal.signal(number, handler)


def _stop(number: int, frame: FrameType | None) -> None:
    """Raise once; closing the files is not to be disturbed."""
    del frame
    for each in (signal.SIGINT, signal.SIGTERM):
        signal.signal(each, signal.SIG_IGN)
    raise Stopped(number)


def _complain(message: str, status: int) -> int:
    sys.stderr.write(f"fairlead: {one_line(message)}\n")
    return status


def _version() -> int:
    import fairlead

    sys.stdout.write(f"fairlead {fairlead.__version__}\n")
    return 0


def _run(config: Config | NetworkConfig | TargetConfig) -> int:
    if isinstance(config, SimulateConfig):
        return _simulate(config)
    if isinstance(config, RenderConfig):
        return _render(config)
    if isinstance(config, StudyConfig):
        return _study(config)
    if isinstance(config, NetworkConfig):
        return _network(config)
    if isinstance(config, ReproduceConfig):
        return _reproduce(config)
    if isinstance(config, AnnotateConfig):
        return _annotate(config)
    if isinstance(config, BootstrapConfig):
        return _bootstrap(config)
    from fairlead import run
    from fairlead.progress import progress_bar

    if isinstance(config, DemoConfig):
        from fairlead.demo import show_demo

        show_demo(config, progress_bar)
        return 0
    if isinstance(config, EvaluateConfig):
        _show_metrics(run.evaluate(config))
        return 0
    verb = run.track(config, progress_bar) if isinstance(config, TrackConfig) else run.refine(config, progress_bar)
    return _close(verb, config.min_coverage)


def _close(verb: "RunSummary", min_coverage: float) -> int:
    """The closing lines of a run, and its exit status."""
    counts = f"{verb.frames} frames, {verb.frames_with_pose} with a pose ({verb.coverage:.1%})"
    if verb.frames_in_doubt:
        counts += f", {verb.frames_in_doubt} contradict what was told (see the reasons in poses.csv)"
    if verb.observations_dropped:
        dropped = "without finite numbers or a positive definite covariance, or of a landmark twice in a frame"
        counts += f", {verb.observations_dropped} observations dropped ({dropped})"
    if verb.report is not None:
        _show_metrics(verb.report)
    if verb.range_bias is not None:
        counts += ", range finder off by {:+.2f} ± {:.2f} m".format(*verb.range_bias)
    sys.stdout.write(f"{verb.output}: {counts}\n")
    if verb.unjudged is not None:
        return _complain(verb.unjudged, 2)
    if verb.coverage < min_coverage:
        return _complain(f"coverage {verb.coverage:.1%} is below --min-coverage {min_coverage:.1%}", 1)
    return 0


def _simulate(config: SimulateConfig) -> int:
    from fairlead.simulate.folder import write_simulation
    from fairlead.simulate.scenario_file import load_scenario

    source = load_scenario(config.scenario, target=config.target, camera=config.camera)
    written = write_simulation(source, config.output, seed=config.seed)
    counts = f"{written.images} images, {written.observations} observations"
    if written.ranges or written.attitudes:
        counts += f", {written.ranges} ranges, {written.attitudes} attitudes"
    sys.stdout.write(f"{written.output}: {counts}\n")
    return 0


def _render(config: RenderConfig) -> int:
    from fairlead.progress import progress_bar
    from fairlead.render.command import render
    from fairlead.render.errors import RenderError

    try:
        made = render(**vars(config), progress=progress_bar)
    except RenderError as error:
        return _complain(str(error), 2)
    sys.stdout.write(f"{config.output}: {made} pictures made\n")
    return 0


def _network(config: NetworkConfig) -> int:
    from fairlead.progress import progress_bar
    from fairlead.train.command import TrainingError, calibrate, export, train

    verb = {TrainConfig: train, CalibrateConfig: calibrate, ExportConfig: export}[type(config)]
    try:
        lines = verb(**vars(config), progress=progress_bar)
    except TrainingError as error:
        return _complain(str(error), 2)
    sys.stdout.write("".join(f"{line}\n" for line in lines))
    return 0


def _annotate(config: AnnotateConfig) -> int:
    from fairlead.prepare import annotate

    def tell(address: str) -> None:
        sys.stdout.write(f"{config.folder}: {address} (Ctrl-C ends it; every action is saved at once)\n")
        sys.stdout.flush()

    annotate(config, tell)
    return 0


def _bootstrap(config: BootstrapConfig) -> int:
    from fairlead.prepare import bootstrap

    made = bootstrap(config)
    counts = f"{len(made.target.landmarks)} landmarks from {made.views} views, {made.reprojection_rms_px:.2f} px"
    left_out = f" (too few views show {', '.join(made.left_out)})" if made.left_out else ""
    sys.stdout.write(f"{config.output}: {counts}{left_out}\n")
    return 0


def _study(config: StudyConfig) -> int:
    from fairlead.progress import progress_bar
    from fairlead.study import replay_run, run_study

    if config.replay is not None:
        _show_replay(config, replay_run(config))
        return 0
    summary = run_study(config, progress_bar)
    counts = f"{summary.settings} settings, {summary.runs} runs each, {summary.new_runs} of them new"
    sys.stdout.write(f"{summary.output}: {counts}\n")
    for file in summary.files:
        sys.stdout.write(f"{file}\n")
    return 0


def _reproduce(config: ReproduceConfig) -> int:
    from fairlead.progress import progress_bar
    from fairlead.reproduce import reproduce

    summary = reproduce(config, progress_bar)
    for line in summary.missing:
        sys.stdout.write(f"not here: {line}\n")
    sys.stdout.write(f"made: {', '.join(summary.made)}\n{summary.html}\n")
    return 0


def _show_replay(config: StudyConfig, replayed: "Replay") -> None:
    """One run: a line per method, its errors view by view."""
    from rich.console import Console
    from rich.table import Table

    assert config.replay is not None
    table = Table(title=f"{config.replay[0]}, run {config.replay[1]}: means, and the translation error of every view")
    for heading in ("", r"rot. \[deg]", r"transl. \[m]", r"model \[m]", "NEES / 6", r"views \[m]"):
        table.add_column(heading, justify="right" if heading else "left")
    for one in replayed.methods:
        numbers = [one.row[key][0] for key in ("rotation_deg", "translation_m", "landmark_m", "pose_nees")]
        texts = ["" if number != number else f"{number:.2f}" for number in numbers]
        views = "" if one.method.name == "bound" else " ".join(f"{value:.0f}" for value in one.translation_m)
        table.add_row(one.method.name, *texts, views)
    Console().print(table)


def _show_metrics(report: Path) -> None:
    """The numbers of metrics.json on stdout, and where the report is."""
    from rich.console import Console
    from rich.table import Table

    from fairlead.evaluate import METRICS

    runs = json.loads((report.parent / "metrics.json").read_text(encoding="utf-8"))["runs"]
    table = Table("", *runs, "")
    for metric in METRICS:
        cells = [each["metrics"].get(metric.key) for each in runs.values()]
        if any(cell is not None for cell in cells):
            texts = ["" if cell is None else f"{float(cell):.4g}" for cell in cells]
            table.add_row(metric.label, *texts, "" if metric.unit == "-" else metric.unit)
    Console().print(table)
    sys.stdout.write(f"{report}\n")


if __name__ == "__main__":
    sys.exit(main())
