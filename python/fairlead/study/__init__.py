# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Robustness studies: every method on the same simulated flights, many runs a setting. docs/study.md."""

from fairlead.study.block import Task, run_block
from fairlead.study.methods import METHODS
from fairlead.study.replay import Replay, replay, replay_run
from fairlead.study.run import StudySummary, run_study
from fairlead.study.settings import Setting, settings_of

__all__ = [
    "METHODS",
    "Replay",
    "Setting",
    "StudySummary",
    "Task",
    "replay",
    "replay_run",
    "run_block",
    "run_study",
    "settings_of",
]
