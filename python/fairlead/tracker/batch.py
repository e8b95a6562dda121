# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A whole flight in one batch. docs/estimator.md section 5."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from fairlead import _core
from fairlead.tracker.core import LandmarkIndex, TrackerOptions, core_camera, options_for, to_estimate
from fairlead.types import AttitudeReading, Camera, Estimate, RangeReading, Target, View
from fairlead.types.checks import instance

_Record = TypeVar("_Record", View, RangeReading, AttitudeReading)


@dataclass(frozen=True, kw_only=True, eq=False)
class Refinement:
    """What `refine` found."""

    estimates: tuple[Estimate, ...]
    """One per view, in order; status lost and a reason where no pose was found."""
    model: Target
    """The target with the refined landmarks and their full covariance."""
    noise_factor: float
    """Estimated ratio of the true to the told pixel covariances [-]."""
    prior_factor: float
    """Estimated ratio of the true to the told model covariance [-]; the covariance is reported with it."""
    prior_factor_believed: float
    """The smallest that the data allow [-]; the model is estimated with it, docs/estimator.md eq. (16)."""
    cost: float
    """Negative log posterior at the optimum [-], without what a motion prior adds."""
    iterations: int
    converged: bool
    ranges_believed: int = 0
    """Readings of the range finder that were used."""
    ranges_refused: int = 0
    """Readings that did not agree with the others, or were far from any view."""
    range_bias_m: float = 0.0
    """What the range finder always reads too much [m], if `TrackerOptions.range_bias_sigma_m` asks for it."""
    range_bias_sigma_m: float = 0.0
    """One standard deviation of it [m]."""

    @property
    def reprojection_rms_px(self) -> float:
        """Root mean square over both coordinates of all inliers [px]."""
        n = sum(e.n_inliers for e in self.estimates if e.ok)
        squares = sum(e.n_inliers * e.reprojection_rms_px**2 for e in self.estimates if e.ok and e.n_inliers)
        return float(np.sqrt(squares / n)) if n else float("nan")


def refine(
    views: Iterable[View],
    target: Target,
    camera: Camera,
    options: TrackerOptions | None = None,
    *,
    ranges: Iterable[RangeReading] = (),
    attitudes: Iterable[AttitudeReading] = (),
) -> Refinement:
    """All views of a flight in one maximum a posteriori estimate of landmarks and poses, docs/estimator.md section 5.

    Same unknowns, residuals and prior as `Tracker`, nothing marginalised: known distances of the target, readings of
    a range finder and, with a motion prior, the whole path at once, each pose told by what came before and after it.

    Parameters
    ----------
    ranges, attitudes : readings in any order; `TrackerOptions.range_to_origin` is set if one is to the origin

    Raises ValueError as `Tracker` does.
    """
    options = options_for(target, camera, options)
    views, ranges = _all(views, View, "views"), _all(ranges, RangeReading, "ranges")
    attitudes = _all(attitudes, AttitudeReading, "attitudes")
    index = LandmarkIndex(target.landmarks)
    if any(reading.landmark is None for reading in ranges):
        options = replace(options, range_to_origin=True)
    estimates, X, P, noise, prior, believed, cost, iterations, converged, used, refused, bias, sigma = _core.refine(
        core_camera(camera),
        target.positions,
        target.covariance,
        np.array([view.stamp_ns for view in views], dtype=np.int64),
        np.array([len(view.landmarks) for view in views], dtype=np.int32),
        np.concatenate([index(view.landmarks) for view in views] or [np.empty(0, np.int32)]),
        np.concatenate([view.pixels for view in views] or [np.empty((0, 2))]),
        np.concatenate([view.covariances for view in views] or [np.empty((0, 2, 2))]),
        options.to_core(),
        _readings(target, index, ranges, attitudes),
    )
    return Refinement(
        estimates=tuple(to_estimate(view.frame, e, target.landmarks) for view, e in zip(views, estimates, strict=True)),
        model=replace(target, positions=X, covariance=P),
        noise_factor=noise,
        prior_factor=prior,
        prior_factor_believed=believed,
        cost=cost,
        iterations=iterations,
        converged=converged,
        ranges_believed=used,
        ranges_refused=refused,
        range_bias_m=bias,
        range_bias_sigma_m=sigma,
    )


def _all(records: Iterable[_Record], kind: type[_Record], name: str) -> tuple[_Record, ...]:
    """The records, all of this class. Raises ValueError."""
    instance(records, Iterable, name)
    records = tuple(records)
    for record in records:
        instance(record, kind, name)
    return records


def _readings(
    target: Target, index: LandmarkIndex, ranges: Iterable[RangeReading], attitudes: Iterable[AttitudeReading]
) -> _core.BatchReadings:
    """What is known besides the views, as the core's record."""
    core = _core.BatchReadings()
    for distance in target.distances:
        a, b = index(distance.between)
        core.add_length(a, b, distance.length_m, distance.sigma_m)
    for reading in ranges:
        core.add_range(reading.stamp_ns, reading.range_m, reading.sigma_m, index.point(reading.landmark))
    for reading in attitudes:
        core.add_attitude(reading.stamp_ns, reading.R_world_camera, reading.sigma_rad)
    return core
