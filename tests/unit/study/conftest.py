# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The frigate as a study sees it."""

from pathlib import Path

import pytest

from fairlead.config import StudyConfig
from fairlead.study import Task
from fairlead.study.run import task_of


@pytest.fixture(scope="session")
def task() -> Task:
    return task_of(StudyConfig(study="noise", output=Path("unused"), seed=3))
