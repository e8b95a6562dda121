# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Accuracy against benchmarks/baseline.json; `python -m benchmarks --update-baseline` accepts a change."""

import os
import subprocess
import sys

import pytest


@pytest.mark.slow
def test_no_accuracy_was_lost(repository):
    """As a process of its own: the shape checks of the tests would make it three times slower."""
    run = subprocess.run(
        [sys.executable, "-m", "benchmarks"],
        cwd=repository,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
