# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What is compared, and the threads of the core that solve it, docs/study.md section 3."""

from dataclasses import asdict, dataclass, field

import numpy as np
from jaxtyping import Float64

from fairlead import _core
from fairlead.study.flights import FlightBlock, RunPoses
from fairlead.tracker import TrackerOptions, core_camera

_F = _core.FreeWindowOptions()


@dataclass(frozen=True, kw_only=True)
class FreeOptions:
    """What the publication leaves open of the joint solve without a prior; defaults are those of `window`."""

    max_iterations: int = _F.max_iterations
    initial_damping: float = _F.initial_damping
    """Of the first step, relative to the Hessian's diagonal [-]."""
    tolerance: float = _F.tolerance
    """Stops when a step would decrease the cost by less than this share of it [-]."""
    refine_start: bool = _F.refine_start
    """Start from EPnP with its reprojection error minimised instead of from EPnP."""
    pnp_after: bool = _F.pnp_after
    """Poses by PnP on the landmarks found, instead of those of the joint solve."""

    def to_core(self) -> _core.FreeWindowOptions:
        """The same options as the core's record."""
        options = _core.FreeWindowOptions()
        for name, value in asdict(self).items():
            setattr(options, name, value)
        return options


@dataclass(frozen=True, kw_only=True)
class Method:
    """One of the answers that are compared."""

    name: str
    label: str
    """In figures and tables."""
    solver: str
    """Of `_core.Flights.solve`."""
    free: FreeOptions = field(default_factory=FreeOptions)
    covers_model: bool = False
    """Its covariances include the uncertainty of the model: only then can they be true."""


_FROM_EPNP = {"refine_start": False, "pnp_after": False}
METHODS = (
    Method(name="epnp", label="EPnP", solver="start"),
    Method(name="single", label="single view refined", solver="single_view"),
    Method(name="window", label="published window (2 damped steps)", solver="free_window"),
    Method(
        name="window-5",
        label="published window (5 steps)",
        solver="free_window",
        free=FreeOptions(max_iterations=5, initial_damping=0.1, **_FROM_EPNP),
    ),
    Method(
        name="window-3",
        label="published window (3 undamped steps)",
        solver="free_window",
        free=FreeOptions(max_iterations=3, initial_damping=1e-4, **_FROM_EPNP),
    ),
    Method(
        name="free",
        label="full batch without prior",
        solver="free_window",
        free=FreeOptions(max_iterations=50, initial_damping=1e-4, tolerance=1e-6, pnp_after=False),
    ),
    Method(name="map", label="map, batch", solver="map", covers_model=True),
    Method(name="online", label="map, online", solver="online", covers_model=True),
    Method(name="true-model", label="PnP, true model", solver="true_model", covers_model=True),
    Method(name="bound", label="Bayesian bound", solver="bound"),
)
NAMES = tuple(method.name for method in METHODS)


@dataclass(frozen=True, kw_only=True, eq=False)
class Answers:
    """What one method says of the runs of a block; NaN where there is no pose."""

    T_camera_target: RunPoses
    covariances: Float64[np.ndarray, "r k 6 6"]
    """Of xi in T Exp(xi)."""
    X: Float64[np.ndarray, "r n 3"]
    X_covariance: Float64[np.ndarray, "r m m"] | None
    """None where the method says nothing of it."""
    iterations: Float64[np.ndarray, "r"]
    """Linear systems solved; NaN where none is counted."""
    seconds: Float64[np.ndarray, "r"]
    """Processor time."""


class Solver:
    """The flights of a block in the core, to be solved by one method after the other."""

    def __init__(self, block: FlightBlock, T_start: RunPoses) -> None:
        self._flights = _core_flights(block, T_start, len(block.runs))
        self._shape = block.pixels.shape
        # The bound depends on the truth, on P0 and on what is seen: if all runs share them, one evaluation serves all.
        alike = bool(np.ptp(block.P0, axis=0).max() == 0.0) and bool(np.isfinite(block.pixels).all())
        self._one = _core_flights(block, T_start, 1) if alike else None

    def solve(self, method: Method, threads: int) -> Answers:
        """Answers of one method; they do not depend on the number of threads."""
        r, k, n, _ = self._shape
        flights = self._flights if method.solver != "bound" or self._one is None else self._one
        rows = flights.solve(method.solver, method.free.to_core(), TrackerOptions().to_core(), threads)
        T, S, X, P, counts = (np.repeat(each, r, axis=0) if flights is self._one else each for each in rows)
        return Answers(
            T_camera_target=T.reshape(r, k, 4, 4),
            covariances=S.reshape(r, k, 6, 6),
            X=X.reshape(r, n, 3),
            X_covariance=P.reshape(r, 3 * n, 3 * n) if P.size else None,
            iterations=counts[:, 0],
            seconds=counts[:, 1],
        )


def _core_flights(block: FlightBlock, T_start: RunPoses, runs: int) -> _core.Flights:
    """The first runs of a block."""
    _, k, n, _ = block.pixels.shape
    covariances = block.setting.scenario.observation.told_covariances(n)
    return _core.Flights(
        core_camera(block.camera),
        _each(block.X_true, runs),
        block.X0[:runs],
        block.P0[:runs],
        block.stamps_ns,
        _each(block.T_true, runs),
        T_start[:runs],
        block.pixels[:runs],
        np.ascontiguousarray(np.broadcast_to(covariances, (runs, k, n, 2, 2))),
    )


def _each(one: np.ndarray, runs: int) -> np.ndarray:
    """The same for every run."""
    return np.ascontiguousarray(np.broadcast_to(one, (runs, *one.shape)))
