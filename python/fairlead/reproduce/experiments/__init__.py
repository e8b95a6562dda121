# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""One file per experiment; each makes one section of the report from the context alone."""

from collections.abc import Callable

from fairlead.reproduce.content import Section
from fairlead.reproduce.context import Context
from fairlead.reproduce.experiments.ablation import ablation
from fairlead.reproduce.experiments.curves import curves
from fairlead.reproduce.experiments.failures import failures
from fairlead.reproduce.experiments.gap import gap
from fairlead.reproduce.experiments.landmarks import landmarks
from fairlead.reproduce.experiments.model import model
from fairlead.reproduce.experiments.overlay import overlay
from fairlead.reproduce.experiments.poses import poses
from fairlead.reproduce.experiments.ranges import ranges
from fairlead.reproduce.experiments.real import real
from fairlead.reproduce.experiments.single_landmarks import single_landmarks
from fairlead.reproduce.experiments.studies import angle, noise
from fairlead.reproduce.experiments.times import times
from fairlead.reproduce.experiments.weather import weather

Experiment = Callable[[Context], Section]

EXPERIMENTS: dict[str, Experiment] = {
    "noise": noise,
    "angle": angle,
    "landmarks": landmarks,
    "poses": poses,
    "gap": gap,
    "model": model,
    "times": times,
    "overlay": overlay,
    "curves": curves,
    "single_landmarks": single_landmarks,
    "real": real,
    "failures": failures,
    "weather": weather,
    "ranges": ranges,
    "ablation": ablation,
}
"""In the order of the report."""
