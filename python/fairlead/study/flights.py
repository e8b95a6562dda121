# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Many flights of one setting at once, as arrays: what `simulate_arc` draws, without a record per view."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from fairlead.baselines.observed import Observed
from fairlead.baselines.single_view import NEARLY_FLAT, solve_view
from fairlead.opencv import epnp_views
from fairlead.simulate import project_all
from fairlead.study.settings import Setting
from fairlead.types import Camera, Points3, Poses, Target

RunPoints = Float64[np.ndarray, "r n 3"]
RunCovariances = Float64[np.ndarray, "r m m"]
RunPixels = Float64[np.ndarray, "r k n 2"]
RunPoses = Float64[np.ndarray, "r k 4 4"]
Stamps = Int64[np.ndarray, "k"]


@dataclass(frozen=True, kw_only=True, eq=False)
class FlightBlock:
    """Some runs of one setting; all see every landmark in every view."""

    setting: Setting
    runs: tuple[int, ...]
    camera: Camera
    X_true: Points3
    """[m]; the same in all runs."""
    T_true: Poses
    """T_camera_target; the same in all runs."""
    stamps_ns: Stamps
    X0: RunPoints
    """The landmarks that are told [m]."""
    P0: RunCovariances
    """The covariance that is told with them [m^2]."""
    pixels: RunPixels
    """What is observed [px]."""


def draw_flights(target: Target, camera: Camera, setting: Setting, runs: Sequence[int], seed: int) -> FlightBlock:
    """Draw these runs, each from a generator of its own.

    Parameters
    ----------
    target : its positions are the truth
    camera : landmarks outside the image are observed all the same, as by `simulate_arc`
    setting : geometry and errors
    runs : numbers of the runs
    seed : of the study
    """
    scenario = setting.scenario
    X = target.positions
    T = scenario.poses(X)
    pixels_true = project_all(camera, X, T)
    X0 = np.empty((len(runs), *X.shape))
    P0 = np.empty((len(runs), X.size, X.size))
    pixels = np.empty((len(runs), *pixels_true.shape))
    for i, run in enumerate(runs):
        rng = setting.generator(seed, run)
        X0[i] = scenario.model.draw(X, rng)
        P0[i] = scenario.model.told_covariance(X0[i])
        pixels[i] = scenario.observation.draw(pixels_true, rng)
    return FlightBlock(
        setting=setting,
        runs=tuple(runs),
        camera=camera,
        X_true=X,
        T_true=T,
        stamps_ns=np.arange(setting.views, dtype=np.int64) * round(scenario.interval_s * 1e9),
        X0=X0,
        P0=P0,
        pixels=pixels,
    )


def first_poses(block: FlightBlock) -> RunPoses:
    """EPnP of every view on the told model, NaN where it has no answer: what `epnp` reports, and others start from."""
    return np.stack([_epnp(block, X0, z) for X0, z in zip(block.X0, block.pixels, strict=True)])


def _epnp(block: FlightBlock, X0: Points3, pixels: np.ndarray) -> Poses:
    """All views of one run; landmarks that are nearly flat go the way of `EpnpTracker`."""
    size = np.linalg.svd(X0 - X0.mean(axis=0), compute_uv=False)
    if size[2] >= NEARLY_FLAT * size[1]:
        return epnp_views(X0, pixels, block.camera)
    index = np.arange(len(X0), dtype=np.int64)
    covariances = block.setting.scenario.observation.told_covariances(len(X0))
    T = np.full((len(pixels), 4, 4), np.nan)
    for k, z in enumerate(pixels):
        seen = Observed(index=index, pixels=z, covariances=covariances)
        found = solve_view(seen, X0, block.camera, refined=False)
        if not isinstance(found, str):
            T[k] = found.T_camera_target
    return T
