# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""One recorded flight by the methods of the study, docs/study.md section 3; and which core is in use."""

import hashlib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Literal

import numpy as np

from fairlead import _core
from fairlead.study.methods import FreeOptions
from fairlead.tracker import TrackerOptions, core_camera
from fairlead.types import Camera, Target


@dataclass(frozen=True, kw_only=True, eq=False)
class RecordedFlight:
    """What was told and seen of k views of n landmarks, beside the truth."""

    camera: Camera
    """Without distortion; the pixels are ideal ones."""
    X_true: np.ndarray
    """(n, 3) [m]"""
    told: Target
    P0: np.ndarray
    """(3n, 3n) of the told landmarks [m^2]."""
    stamps_ns: np.ndarray
    """(k,)"""
    T_true: np.ndarray
    """(k, 4, 4) T_camera_target, where every method starts."""
    pixels: np.ndarray
    """(k, n, 2) [px]; NaN where a landmark was not seen."""
    covariances: np.ndarray
    """(k, n, 2, 2) [px^2]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class RecordedAnswer:
    """What a method says of it; NaN where it says nothing."""

    T_camera_target: np.ndarray
    """(k, 4, 4)"""
    pose_covariances: np.ndarray
    """(k, 6, 6) of xi."""
    X_covariance: np.ndarray
    """(3n, 3n) [m^2]; nothing of true_model, which knows them."""
    seconds: float


def solve_recorded(method: Literal["true_model", "bound"], flight: RecordedFlight) -> RecordedAnswer:
    """PnP on the true landmarks, or the Bayesian bound (docs/bound.md)."""
    S = flight.covariances
    usable = np.asarray(np.isfinite(flight.pixels).all(axis=2) & np.isfinite(S).all(axis=(2, 3)))
    flights = _core.Flights(
        core_camera(flight.camera),
        np.ascontiguousarray(flight.X_true[None]),
        np.ascontiguousarray(flight.told.positions[None]),
        np.ascontiguousarray(flight.P0[None]),
        flight.stamps_ns,
        np.ascontiguousarray(flight.T_true[None]),
        np.ascontiguousarray(flight.T_true[None]),
        np.ascontiguousarray(np.where(usable[..., None], flight.pixels, np.nan)[None]),
        np.ascontiguousarray(np.where(usable[..., None, None], S, np.eye(2))[None]),
    )
    T, covariances, _, P, counts = flights.solve(method, FreeOptions().to_core(), TrackerOptions().to_core(), 1)
    k, n = flight.pixels.shape[:2]
    return RecordedAnswer(
        T_camera_target=T.reshape(k, 4, 4),
        pose_covariances=covariances.reshape(k, 6, 6),
        X_covariance=P.reshape(3 * n, 3 * n) if P.size else np.empty((0, 0)),
        seconds=float(counts[0, 1]),
    )


@cache
def core_digest() -> str:
    """SHA-256 of the compiled estimator: another one gives other answers."""
    return hashlib.sha256(Path(_core.__file__).read_bytes()).hexdigest()
