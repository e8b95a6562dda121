# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""One file per experiment; each makes one section of the report from the context alone."""

from collections.abc import Callable

from fairlead.reproduce.content import Section
from fairlead.reproduce.context import Context
from fairlead.reproduce.experiments.landmarks import landmarks
from fairlead.reproduce.experiments.model import model
from fairlead.reproduce.experiments.poses import poses
from fairlead.reproduce.experiments.times import times

Experiment = Callable[[Context], Section]

EXPERIMENTS: dict[str, Experiment] = {
    "landmarks": landmarks,
    "poses": poses,
    "model": model,
    "times": times,
}
"""In the order of the report."""
