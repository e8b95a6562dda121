# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""One run of a study once more, method by method and view by view."""

from dataclasses import dataclass

import numpy as np

from fairlead.config import StudyConfig, UsageError
from fairlead.evaluate.pose import rotation_error_deg, translation_error_m
from fairlead.study.block import Prepared, Task, prepare, solve_each
from fairlead.study.methods import Answers, Method
from fairlead.study.run import task_of
from fairlead.study.scores import Columns, score
from fairlead.study.settings import Setting, find_setting, settings_of


@dataclass(frozen=True, kw_only=True, eq=False)
class Replayed:
    """What one method did in one run."""

    method: Method
    row: Columns
    """One number per column, as in the table of the study."""
    rotation_deg: np.ndarray
    """(k,) of each view; NaN where there is no pose."""
    translation_m: np.ndarray
    """(k,)"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Replay:
    """One run: what was drawn, and what the methods made of it."""

    prepared: Prepared
    answers: dict[str, Answers]
    methods: tuple[Replayed, ...]


def replay_run(config: StudyConfig) -> Replay:
    """The run that `config.replay` names. Raises UsageError if the study has no such setting."""
    assert config.replay is not None
    name, run = config.replay
    try:
        setting = find_setting(settings_of(config.study), name)
    except ValueError as error:
        raise UsageError(f"--replay: {error}") from error
    return replay(task_of(config), setting, run)


def replay(task: Task, setting: Setting, run: int) -> Replay:
    """The same numbers as in the study, whatever else ran there."""
    prepared = prepare(task, setting, (run,))
    answers = solve_each(task, prepared, threads=1)
    T_true = prepared.block.T_true
    methods = tuple(
        Replayed(
            method=method,
            row=score(prepared.block, method, answers[method.name]),
            rotation_deg=rotation_error_deg(answers[method.name].T_camera_target[0], T_true),
            translation_m=translation_error_m(answers[method.name].T_camera_target[0], T_true),
        )
        for method in task.chosen
    )
    return Replay(prepared=prepared, answers=answers, methods=methods)
