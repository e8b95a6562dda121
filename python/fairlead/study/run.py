# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""`fairlead study`: runs what is missing, then tables and figures; may be stopped and started again."""

import fnmatch
import json
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fairlead
from fairlead.baselines.observed import plain
from fairlead.config import StudyConfig, UsageError
from fairlead.io.camera import load_camera
from fairlead.io.errors import InputError
from fairlead.io.run_record import git_commit, input_file, write_json
from fairlead.io.shipped import shipped_data
from fairlead.io.target import load_target
from fairlead.progress import ProgressFactory, silent
from fairlead.study.backends import Block, with_dask, with_threads
from fairlead.study.block import Result, Task, block_size
from fairlead.study.methods import NAMES
from fairlead.study.rows import close_rows, read_rows, row_stream, runs_done
from fairlead.study.settings import Setting, settings_of

RECORD = "study.json"
_MIN_LANDMARKS = 4


@dataclass(frozen=True, kw_only=True)
class StudySummary:
    """What a study has done."""

    output: Path
    settings: int
    runs: int
    """Of each setting."""
    new_runs: int
    """Of all settings, this time."""
    files: tuple[Path, ...]
    """Tables and figures."""


def run_study(config: StudyConfig, progress: ProgressFactory = silent) -> StudySummary:
    """Do the runs that the folder does not hold yet; write tables and figures of all of them.

    Raises InputError or UsageError for what cannot be done, also if the folder holds a study of something else.
    """
    from fairlead.study.report import write_report

    task, settings = task_of(config), chosen_settings(config)
    config.output.mkdir(parents=True, exist_ok=True)
    _claim(config, task)
    rows = read_rows(config.output)
    done = runs_done(rows, len(task.methods))
    blocks = missing_blocks(settings, config.runs, done)
    count = sum(len(runs) for _, runs in blocks)
    with row_stream(config.output, rows) as stream, progress("runs", lambda: count) as advance:
        for result in _solve(config, task, blocks):
            stream.write(result)
            advance(len(result.runs))
    files = write_report(config.output, config.study, settings, close_rows(config.output))
    return StudySummary(
        output=config.output, settings=len(settings), runs=config.runs, new_runs=count, files=tuple(files)
    )


def task_of(config: StudyConfig) -> Task:
    """Target, camera and methods; those of the frigate unless others are named."""
    target_path, camera_path = _inputs(config)
    target = load_target(target_path)
    if len(target.landmarks) < _MIN_LANDMARKS:
        raise InputError(target_path, f"expected at least {_MIN_LANDMARKS} landmarks, got {len(target.landmarks)}")
    unknown = sorted(set(config.methods or ()) - set(NAMES))
    if unknown:
        raise UsageError(f"--methods: expected some of {', '.join(NAMES)}, got {unknown[0]!r}")
    methods = NAMES if config.methods is None else tuple(name for name in NAMES if name in config.methods)
    return Task(target=target, camera=plain(load_camera(camera_path)), seed=config.seed, methods=methods)


def chosen_settings(config: StudyConfig) -> tuple[Setting, ...]:
    """The settings of the study whose names match."""
    settings = settings_of(config.study)
    chosen = tuple(each for each in settings if fnmatch.fnmatchcase(each.name, config.only))
    if not chosen:
        raise UsageError(f"--only: {config.only!r} matches none of {', '.join(s.name for s in settings[:3])}, ...")
    return chosen


def missing_blocks(settings: Sequence[Setting], runs: int, done: dict[str, set[int]]) -> list[Block]:
    """What is left to do, a few runs of every setting first: a study that is stopped has about as many of each."""
    queues: list[list[Block]] = []
    for setting in settings:
        there = done.get(setting.name, set())
        left = [run for run in range(runs) if run not in there]
        size = block_size(setting)
        queues.append([(setting, tuple(left[i : i + size])) for i in range(0, len(left), size)])
    order = sorted((block[1][0], number, block[1]) for number, queue in enumerate(queues) for block in queue)
    return [(settings[number], each) for _, number, each in order]


def _solve(config: StudyConfig, task: Task, blocks: Sequence[Block]) -> Iterator[Result]:
    if config.backend == "dask":
        assert config.scheduler is not None
        return with_dask(task, blocks, config.scheduler)
    threads = config.threads or len(os.sched_getaffinity(0))
    return with_threads(task, blocks, threads)


def _inputs(config: StudyConfig) -> tuple[Path, Path]:
    frigate = shipped_data("frigate")
    return config.target or frigate / "target.toml", config.camera or frigate / "camera.yaml"


def _claim(config: StudyConfig, task: Task) -> None:
    """Write study.json, or check that what the folder holds is of the same study."""
    target, camera = (input_file(role, path) for role, path in zip(("target", "camera"), _inputs(config), strict=True))
    mine: dict[str, Any] = {
        "study": config.study,
        "seed": config.seed,
        "methods": list(task.methods),
        "target": target.sha256,
        "camera": camera.sha256,
        "version": fairlead.__version__,
    }
    path = config.output / RECORD
    if path.exists():
        try:
            theirs = json.loads(path.read_text(encoding="utf-8"))["identity"]
        except (ValueError, KeyError, TypeError) as error:
            raise InputError(path, f"no record of a study: {error}") from error
        for name, value in mine.items():
            if theirs.get(name) != value:
                raise InputError(path, f"another study is here: its {name} is {theirs.get(name)}, expected {value}")
    write_json(path, {"identity": mine, "runs": config.runs, "only": config.only, "git": git_commit()})
