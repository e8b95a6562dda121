# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A block of runs of one setting: drawn, solved by every method, scored. What one worker does at a time."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fairlead.study.flights import FlightBlock, RunPoses, draw_flights, first_poses
from fairlead.study.methods import METHODS, Answers, Method, Solver
from fairlead.study.scores import Columns, score
from fairlead.study.settings import Setting
from fairlead.types import Camera, Target

_VIEWS_IN_A_BLOCK = 400
_RUNS_IN_A_BLOCK = 32


@dataclass(frozen=True, kw_only=True, eq=False)
class Task:
    """What all runs of a study share. May be sent to another process."""

    target: Target
    """Its positions are the truth."""
    camera: Camera
    seed: int
    methods: tuple[str, ...]

    @property
    def chosen(self) -> tuple[Method, ...]:
        """The methods, in their order."""
        return tuple(method for method in METHODS if method.name in self.methods)


@dataclass(frozen=True, kw_only=True, eq=False)
class Prepared:
    """Flights with the answers of EPnP."""

    block: FlightBlock
    T_epnp: RunPoses
    milliseconds: float
    """Processor time of EPnP per run."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Result:
    """Rows of one block: for each method one array per column, in the order of the runs."""

    setting: Setting
    runs: tuple[int, ...]
    columns: dict[str, Columns]


def block_size(setting: Setting) -> int:
    """Runs that are done in a fraction of a second."""
    return max(1, min(_RUNS_IN_A_BLOCK, _VIEWS_IN_A_BLOCK // setting.views))


def prepare(task: Task, setting: Setting, runs: Sequence[int]) -> Prepared:
    """Draw the flights and ask OpenCV."""
    block = draw_flights(task.target, task.camera, setting, runs, task.seed)
    start_s = time.thread_time()
    T_epnp = first_poses(block)
    return Prepared(block=block, T_epnp=T_epnp, milliseconds=1e3 * (time.thread_time() - start_s) / max(len(runs), 1))


def solve_each(task: Task, prepared: Prepared, threads: int) -> dict[str, Answers]:
    """Answers of every method."""
    solver = Solver(prepared.block, prepared.T_epnp)
    return {method.name: solver.solve(method, threads) for method in task.chosen}


def finish(task: Task, prepared: Prepared, threads: int) -> Result:
    """Solve and score."""
    answers = solve_each(task, prepared, threads)
    columns = {method.name: score(prepared.block, method, answers[method.name]) for method in task.chosen}
    if "epnp" in columns:
        columns["epnp"]["milliseconds"] = np.full(len(prepared.block.runs), prepared.milliseconds)
    return Result(setting=prepared.block.setting, runs=prepared.block.runs, columns=columns)


def run_block(task: Task, setting: Setting, runs: Sequence[int], threads: int = 1) -> Result:
    """All of it. The numbers, times apart, depend on the task, the setting and each run's number alone."""
    return finish(task, prepare(task, setting, runs), threads)
