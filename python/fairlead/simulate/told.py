# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The rough model: which landmarks are true and which are told. docs/simulate.md eq. (28)-(30)."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from fairlead.simulate.errors import factor
from fairlead.simulate.scenario import Scenario
from fairlead.simulate.streams import Streams
from fairlead.types import KnownDistance, ModelCovariance, Points3, Target, Vector3


def draw_targets(scenario: Scenario, streams: Streams) -> tuple[Target, Target]:
    """(true, told). The told one holds nothing that only truth knows: no surface, no exact length, no exact point."""
    given = scenario.target
    drawn, told_covariance = _draw(scenario, streams)
    truth_is_given = scenario.target_is == "truth"
    X_true, X_told = (given.positions, drawn) if truth_is_given else (drawn, given.positions)
    true = _known_exactly(given)
    if not truth_is_given:
        true = replace(true, positions=X_true, touchdown=_moved_point(given, drawn))
    told = replace(
        given,
        positions=X_told,
        covariance=told_covariance,
        mesh=None if truth_is_given else given.mesh,
        touchdown=_moved_point(given, drawn) if truth_is_given else given.touchdown,
        distances=_measured(given, X_true, streams),
        motion=given.motion if scenario.motion is None else scenario.motion,
    )
    return true, told


@lru_cache(maxsize=16)
def _known_exactly(given: Target) -> Target:
    """The target as it is, without uncertainty; the same in all runs of a study."""
    return replace(given, covariance=np.zeros_like(given.covariance), distances=())


def _draw(scenario: Scenario, streams: Streams) -> tuple[Points3, ModelCovariance]:
    """Landmarks that scatter about the given ones, eq. (28), and the covariance that is told, eq. (29)."""
    given, rng = scenario.target, streams.of("model")
    if scenario.model is None:
        errors = factor(given.covariance) @ rng.standard_normal(given.positions.size)
        return given.positions + errors.reshape(-1, 3), given.covariance
    drawn = scenario.model.draw(given.positions, rng)
    told = drawn if scenario.target_is == "truth" else given.positions
    return drawn, scenario.model.told_covariance(told)


def _moved_point(target: Target, drawn: Points3) -> Vector3 | None:
    """The touchdown point where it is a landmark, which has moved; else it cannot be known."""
    if target.touchdown is None:
        return None
    same = np.flatnonzero((target.positions == target.touchdown).all(axis=1))
    return drawn[same[0]] if len(same) else None


def _measured(target: Target, X_true: Points3, streams: Streams) -> tuple[KnownDistance, ...]:
    """The known distances as measured once more on the true landmarks, eq. (30)."""
    if not target.distances:
        return ()
    rng = streams.of("distances")
    measured: list[KnownDistance] = []
    for distance in target.distances:
        first, second = (X_true[target.landmarks.index(name)] for name in distance.between)
        length = float(np.linalg.norm(first - second)) + distance.sigma_m * float(rng.standard_normal())
        measured.append(replace(distance, length_m=length))
    return tuple(measured)
