# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The methods that the grid compares, each a function of what is told: a simulated flight in, an answer out."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from benchmarks.scoring import Answer, answer_of
from fairlead.baselines.epnp import EpnpTracker
from fairlead.baselines.free_window import free_batch
from fairlead.simulate import Simulation
from fairlead.tracker import refine
from fairlead.types import Camera, Estimate, Target, View

Method = Callable[[Sequence[View], Target, Camera], Answer]


def _poses(estimates: Sequence[Estimate]) -> np.ndarray:
    return np.stack([estimate.T_camera_target for estimate in estimates])


def run_map(views: Sequence[View], target: Target, camera: Camera) -> Answer:
    """The batch with the model prior."""
    found = refine(views, target, camera)
    return answer_of(found.estimates, found.model)


def run_epnp(views: Sequence[View], target: Target, camera: Camera) -> Answer:
    """EPnP view by view on the told model."""
    tracker = EpnpTracker(target, camera)
    return Answer(T=_poses([tracker.update(view) for view in views]), X=target.positions)


def run_window(views: Sequence[View], target: Target, camera: Camera) -> Answer:
    """The published joint optimisation over all views: no prior."""
    found = free_batch(views, target, camera)
    return Answer(T=_poses(found.estimates), X=found.model.positions)


METHODS: dict[str, Method] = {"epnp": run_epnp, "window": run_window, "map": run_map}

TOLD: dict[str, tuple[float, float]] = {
    "map": (1.0, 1.0),
    "map-sigma-half": (0.5, 1.0),
    "map-sigma-double": (2.0, 1.0),
    "map-prior-third": (1.0, 1.0 / 3.0),
    "map-prior-triple": (1.0, 3.0),
}
"""Factors on the told standard deviations of the observations and of the model, per variant of `map`."""


def answer(name: str, flight: Simulation) -> Answer:
    """Run a method of METHODS or TOLD on what the flight tells, changed as the name says.

    The baselines use neither the level of the noise nor the prior, so only `map` is told wrong ones.
    """
    if name not in TOLD:
        return METHODS[name](flight.views, flight.target_told, flight.camera)
    sigma, prior = TOLD[name]
    views, target = flight.views, flight.target_told
    if sigma != 1.0:
        views = tuple(replace(view, covariances=sigma**2 * view.covariances) for view in views)
    if prior != 1.0:
        target = replace(target, covariance=prior**2 * target.covariance)
    return run_map(views, target, flight.camera)
