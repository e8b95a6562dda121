# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights at the level of landmarks: where each method breaks, docs/reproduce.md section 9."""

from dataclasses import dataclass, replace

import numpy as np

from fairlead.reproduce.measured import Observed, views_of
from fairlead.reproduce.methods import Flight
from fairlead.simulate import ArcScenario, ModelError, ObservationError, project_all
from fairlead.types import Camera, Target

INTERVAL_S = 0.5


@dataclass(frozen=True, kw_only=True)
class Hardship:
    """What is hard about a flight: an arc at 1 km about the stern, a view every half second."""

    sigma_px: float = 1.0
    angle_deg: float = 90.0
    outliers: float = 0.0
    """Share of the observations that are 30 px off."""
    occluded: float = 0.0
    """Share of the landmarks that is hidden in every view after the first ten: those farthest ahead."""
    views: int = 60


def hard_flight(target: Target, camera: Camera, hardship: Hardship, seed: int) -> Flight:
    """Draw one; the landmarks of `target` are the truth."""
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(20_240_818,)))
    noise = ObservationError(sigma_px=hardship.sigma_px, outlier_fraction=hardship.outliers)
    model = ModelError(sigma_m=1.0)
    scenario = ArcScenario(
        angle_deg=hardship.angle_deg, views=hardship.views, interval_s=INTERVAL_S, model=model, observation=noise
    )
    X = target.positions
    T = scenario.poses(X)
    X0 = model.draw(X, rng)
    exact = project_all(camera, X, T)
    pixels = noise.draw(exact, rng)
    hidden = _hidden(X, hardship.occluded)
    pixels[_FREE_VIEWS:, hidden] = np.nan
    covariances = np.broadcast_to(noise.told_covariances(len(X)), (len(T), len(X), 2, 2))
    observed = Observed(
        stamps_ns=np.arange(len(T), dtype=np.int64) * round(INTERVAL_S * 1e9),
        pixels=pixels,
        covariances=covariances.copy(),
        errors=pixels - exact,
        visible=np.asarray(np.isfinite(pixels).all(axis=2)),
    )
    told = replace(target, positions=X0, covariance=model.told_covariance(X0), mesh=None, touchdown=None, distances=())
    return Flight(
        camera=camera,
        views=views_of(target.landmarks, observed),
        observed=observed,
        told=told,
        X_true=X,
        T_true=np.asarray(T),
    )


_FREE_VIEWS = 10


def _hidden(X: np.ndarray, share: float) -> np.ndarray:
    """The landmarks farthest along x, as if something drove in front of the bow."""
    count = round(share * len(X))
    return np.argsort(-X[:, 0], kind="stable")[:count]
