# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Who is compared, and what each says of one sequence with one told model."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fairlead.baselines.epnp import EpnpTracker
from fairlead.baselines.free_window import WindowTracker
from fairlead.baselines.observed import plain
from fairlead.evaluate.alignment import model_alignment
from fairlead.reproduce.measured import Observed
from fairlead.sources.readings import SensorReadings
from fairlead.study.recorded import RecordedFlight, solve_recorded
from fairlead.tracker import Tracker, TrackerOptions, refine
from fairlead.types import Camera, Estimate, PoseEstimator, RangeReading, Target, View

EPNP, WINDOW, ONLINE, BATCH, TRUE, BOUND = "epnp", "window", "map", "refine", "true-model", "bound"
METHODS = (EPNP, WINDOW, ONLINE, BATCH, TRUE)
OURS = (ONLINE, BATCH)
LABELS = {
    EPNP: "EPnP",
    WINDOW: "published window",
    ONLINE: "fairlead, online",
    BATCH: "fairlead, batch",
    TRUE: "PnP, true model",
    BOUND: "Bayesian bound",
}
_DOUBTFUL, _LEAST = 3.0, 6
STATUSES = ("acquiring", "tracking", "coasting", "lost")


@dataclass(frozen=True, kw_only=True, eq=False)
class Track:
    """What one method says of a sequence: k frames with truth, n landmarks. NaN where it says nothing."""

    T_camera_target: np.ndarray
    """(k, 4, 4)"""
    covariances: np.ndarray
    """(k, 6, 6) of xi."""
    model_m: np.ndarray
    """(k,) mean distance of the landmarks from the true ones, as they are at each frame [m]."""
    status: np.ndarray
    """(k,) number in STATUSES."""
    update_ms: np.ndarray
    """(k,) wall time of each update; of the batch: its time divided by k."""
    X: np.ndarray
    """(n, 3) landmarks at the end [m]."""
    X_covariance: np.ndarray
    """(3n, 3n), or nothing where the method says nothing of it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Flight:
    """All that the methods are told, and the truth that they are judged by."""

    camera: Camera
    views: tuple[View, ...]
    """Of the frames with truth, in order; a frame without observations is an empty view."""
    observed: Observed
    told: Target
    X_true: np.ndarray
    T_true: np.ndarray
    ranges: tuple[RangeReading, ...] = ()


def solve(flight: Flight, methods: Sequence[str] = METHODS, options: TrackerOptions | None = None) -> dict[str, Track]:
    """Every method in turn. `options` are those of ours; the baselines get the views without what looks doubtful."""
    options = options or TrackerOptions()
    confident = replace(flight, views=tuple(confident_view(view) for view in flight.views))
    found: dict[str, Track] = {}
    for method in methods:
        if method == TRUE:
            found[method] = _true_model(flight)
        elif method == BATCH:
            found[method] = _batch(flight, options)
        else:
            told = flight if method == ONLINE else confident
            found[method] = _online(told, _MAKE[method](told, options), model_covariance=method == ONLINE)
    return found


_MAKE: dict[str, Callable[[Flight, TrackerOptions], PoseEstimator]] = {
    EPNP: lambda flight, _: EpnpTracker(flight.told, flight.camera),
    WINDOW: lambda flight, _: WindowTracker(flight.told, flight.camera),
    ONLINE: lambda flight, options: Tracker(flight.told, flight.camera, options),
}


def confident_view(view: View) -> View:
    """What a user of EPnP would keep: no landmark whose told standard deviation is above three times the median.

    EPnP weighs all landmarks alike, and a network guesses at hidden ones. Six stay in any case.
    """
    with np.errstate(invalid="ignore"):
        sigma = np.sqrt(0.5 * np.trace(view.covariances, axis1=1, axis2=2))
    known = sigma[np.isfinite(sigma)]
    if len(known) <= _LEAST:
        return view
    limit = max(_DOUBTFUL * float(np.median(known)), float(np.sort(known)[_LEAST - 1]))
    kept = np.flatnonzero(sigma <= limit)
    return replace(
        view,
        landmarks=tuple(view.landmarks[j] for j in kept),
        pixels=view.pixels[kept],
        covariances=view.covariances[kept],
        scores=None,
    )


def _online(flight: Flight, estimator: PoseEstimator, *, model_covariance: bool) -> Track:
    """View by view."""
    readings = SensorReadings(ranges=flight.ranges)
    estimates: list[Estimate] = []
    times: list[float] = []
    models: list[float] = []
    for view in flight.views:
        start_s = time.perf_counter()
        if isinstance(estimator, Tracker):
            readings.tell(estimator, view)
        estimates.append(estimator.update(view))
        times.append(1e3 * (time.perf_counter() - start_s))
        models.append(model_error_m(estimator.model.positions, flight.X_true))
    model = estimator.model
    return _track(
        estimates, np.array(models), np.array(times), model, model.covariance if model_covariance else np.empty((0, 0))
    )


def _batch(flight: Flight, options: TrackerOptions) -> Track:
    start_s = time.perf_counter()
    found = refine(flight.views, flight.told, flight.camera, options)
    milliseconds = 1e3 * (time.perf_counter() - start_s) / max(len(flight.views), 1)
    k = len(flight.views)
    models = np.full(k, model_error_m(found.model.positions, flight.X_true))
    return _track(found.estimates, models, np.full(k, milliseconds), found.model, found.model.covariance)


def _track(
    estimates: Sequence[Estimate], models: np.ndarray, times: np.ndarray, model: Target, covariance: np.ndarray
) -> Track:
    return Track(
        T_camera_target=np.array([each.T_camera_target for each in estimates]),
        covariances=np.array([each.covariance for each in estimates]),
        model_m=models,
        status=np.array([STATUSES.index(each.status) for each in estimates], dtype=np.int64),
        update_ms=times,
        X=model.positions,
        X_covariance=covariance,
    )


def _true_model(flight: Flight) -> Track:
    """PnP on the true landmarks with a robust loss, started at the true pose, docs/study.md section 3."""
    k, n = flight.observed.pixels.shape[:2]
    answer = solve_recorded("true_model", recorded(flight, np.zeros((3 * n, 3 * n))))
    known = np.isfinite(answer.T_camera_target).all(axis=(1, 2))
    return Track(
        T_camera_target=answer.T_camera_target,
        covariances=answer.pose_covariances,
        model_m=np.zeros(k),
        status=np.where(known, STATUSES.index("tracking"), STATUSES.index("lost")),
        update_ms=np.full(k, 1e3 * answer.seconds / k),
        X=flight.X_true,
        X_covariance=np.empty((0, 0)),
    )


def recorded(flight: Flight, P0: np.ndarray, covariances: np.ndarray | None = None) -> RecordedFlight:
    """The flight as the study takes it; `covariances`: instead of the told ones, (k, n, 2, 2)."""
    return RecordedFlight(
        camera=plain(flight.camera),
        X_true=flight.X_true,
        told=flight.told,
        P0=P0,
        stamps_ns=flight.observed.stamps_ns,
        T_true=flight.T_true,
        pixels=flight.observed.pixels,
        covariances=flight.observed.covariances if covariances is None else covariances,
    )


def model_error_m(X: np.ndarray, X_true: np.ndarray, *, aligned: bool = False) -> float:
    """Mean distance of the landmarks [m], raw or after the best similarity, docs/metrics.md eq. (10)."""
    if aligned:
        similarity = model_alignment(X, X_true, "sim3")
        if similarity is None:
            return float("nan")
        return float(np.linalg.norm(similarity.apply(X) - X_true, axis=1).mean())
    return float(np.linalg.norm(X - X_true, axis=1).mean())
