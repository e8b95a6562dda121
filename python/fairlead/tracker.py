# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The estimator for Python: typed wrappers of the C++ core, no algorithm.

`Tracker` takes one view after the other (mode `map`); `refine` solves a whole flight in one batch. docs/estimator.md.
"""

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np

from fairlead import _core
from fairlead.types import Camera, Estimate, Matrix3, Matrix4, Matrix6, Target, View

_D = _core.TrackerOptions()


@dataclass(frozen=True, kw_only=True)
class TrackerOptions:
    """Options of `Tracker` and `refine`; the defaults are those of the C++ core."""

    max_views: int = _D.max_views
    """Keyframes kept and relinearised [views]. More cost time; too few lose accuracy while the model is still poor."""
    loss_threshold: float = _D.loss_threshold
    """Squared whitened residual [-] where the robust loss turns. Too small wastes data, too large believes outliers."""
    gate: float = _D.gate
    """Squared whitened innovation [-] of an outlier. Too small loses a target that turns, too large lets errors in."""
    min_inlier_ratio: float = _D.min_inlier_ratio
    """Share of the observations [-] that a pose must explain. Too small believes chance, too large gives up early."""
    coast_limit_s: float = _D.coast_limit_s
    """Time without a fresh pose [s] until the estimate is no longer valid."""
    max_step_rad: float = _D.max_step_rad
    """A larger turn between two views [rad] needs evidence."""
    confirmations: int = _D.confirmations
    """Views that must agree before such a turn is believed."""
    ambiguity_log_odds: float = _D.ambiguity_log_odds
    """Two poses whose log odds [nat] are closer than this are both kept."""
    motion: str = _D.motion
    """What is smooth in time: none, range, target or world, docs/motion.md. With none, the target's own holds."""
    jerk_density_m_s25: float = _D.jerk_density_m_s25
    """Root of the power spectral density of its jerk [m/s^2.5], as a first guess: the data judge it."""
    correlation_time_s: float = _D.correlation_time_s
    """Time over which detections err alike [s]: neighbouring views then say little new, docs/motion.md eq. (12)."""
    range_to_origin: bool = _D.range_to_origin
    """Whether readings of the range to the target's origin will come, docs/range.md."""
    seed: int = _D.seed
    """Of the consensus search."""

    def to_core(self) -> _core.TrackerOptions:
        """The same options as the core's record."""
        options = _core.TrackerOptions()
        for name, value in asdict(self).items():
            setattr(options, name, value)
        return options


def core_camera(camera: Camera) -> _core.Camera:
    """The same camera as the core's record."""
    return _core.Camera(camera.model, camera.width, camera.height, camera.K, camera.distortion)


class LandmarkIndex:
    """Landmark names to numbers; ValueError names the nearest known landmark."""

    def __init__(self, landmarks: Sequence[str]) -> None:
        self._number = {name: i for i, name in enumerate(landmarks)}

    def __call__(self, names: Sequence[str]) -> np.ndarray:
        """Numbers of these landmarks, int32."""
        try:
            return np.array([self._number[name] for name in names], dtype=np.int32)
        except KeyError as error:
            near = difflib.get_close_matches(str(error.args[0]), self._number, n=1)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            raise ValueError(f"view landmarks: {error.args[0]!r} is not in the target{hint}") from None


_CoreEstimate = tuple[int, str, str, np.ndarray, np.ndarray, int, int, float, float, int, list[int]]


def _estimate(frame: int, core: _CoreEstimate, landmarks: Sequence[str]) -> Estimate:
    stamp_ns, status, reason, T, covariance, n_inliers, _, rms, information, resets, inliers = core
    return Estimate(
        frame=frame,
        stamp_ns=stamp_ns,
        status=status,  # pyright: ignore[reportArgumentType]
        reason=reason,
        T_camera_target=T,
        covariance=covariance,
        n_inliers=n_inliers,
        reprojection_rms_px=rms,
        information_gained=information,
        reset_counter=resets,
        inliers=tuple(landmarks[j] for j in inliers),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Observability:
    """Of the current model, docs/range.md."""

    gauge_sigma_told: np.ndarray
    """Before the first view: translation x y z [m], rotation x y z [rad], scale [-], one standard deviation each."""
    gauge_sigma: np.ndarray
    """Now."""
    determined: float
    """Directions of the model that the data determine, of 3N."""


class Tracker:
    """Pose of a roughly known target in every view, and the model getting better as views come in.

    Minimises E = 1/2 [|X - X0|^2_(P0^-1) + sum_kj rho(r_kj^T S_kj^-1 r_kj)] over landmarks X and poses T_k of a bounded
    window, docs/estimator.md eq. (1), (3); views that leave the window are compressed, not dropped, eq. (11).

    Parameters
    ----------
    target : landmark model with its covariance P0 [m^2]
    camera : calibrated camera
    options : defaults suit most uses

    Raises ValueError for fewer than four landmarks or an unusable camera, covariance or option.
    """

    def __init__(self, target: Target, camera: Camera, options: TrackerOptions | None = None) -> None:
        self._target = target
        self._index = LandmarkIndex(target.landmarks)
        options = options or TrackerOptions()
        motion = target.motion
        if motion is not None and options.motion == "none":
            options = replace(options, motion=motion.kind, jerk_density_m_s25=motion.jerk_density_m_s25)
        self._core = _core.Tracker(core_camera(camera), target.positions, target.covariance, options.to_core())
        for distance in target.distances:
            a, b = self._index(distance.between)
            self._core.add_length(a, b, distance.length_m, distance.sigma_m)

    def add_range(self, stamp_ns: int, range_m: float, sigma_m: float, landmark: str | None = None) -> None:
        """A reading of a range finder [m], camera to landmark (None: to the target's origin), for the next view.

        Give readings in the order of their stamps. One that does not agree with those before it is not believed,
        docs/range.md. Raises ValueError for an unknown landmark, numbers that are not positive, or a range to the
        origin without `TrackerOptions.range_to_origin`.
        """
        number = _core.ORIGIN if landmark is None else int(self._index([landmark])[0])
        self._core.add_range(stamp_ns, range_m, sigma_m, number)

    def add_attitude(self, stamp_ns: int, R_world_camera: Matrix3, sigma_rad: float) -> None:
        """The camera's attitude in a world-aligned frame at a view's stamp, for motion `world`, docs/motion.md.

        Raises ValueError unless it is a rotation.
        """
        self._core.add_attitude(stamp_ns, R_world_camera, sigma_rad)

    def add_pose(self, stamp_ns: int, T_camera_target: Matrix4, covariance: Matrix6) -> None:
        """Where the target is thought to be while it is not tracked: the search of the next view starts there.

        Raises ValueError unless it is a rigid motion with a positive definite covariance of xi in T Exp(xi).
        """
        self._core.add_pose(stamp_ns, np.ascontiguousarray(T_camera_target)[None], covariance)

    def update(self, view: View) -> Estimate:
        """Take in one view; bad data end in the status, never in an exception.

        Raises ValueError only if the view names a landmark that the target does not have.
        """
        core = self._core.update(view.stamp_ns, self._index(view.landmarks), view.pixels, view.covariances)
        return _estimate(view.frame, core, self._target.landmarks)

    @property
    def model(self) -> Target:
        """The target with the current landmarks [m] and their full covariance [m^2]."""
        return replace(self._target, positions=self._core.landmarks(), covariance=self._core.landmark_covariance())

    def observability(self) -> "Observability":
        """What the data have fixed of the model, and what only the prior holds, docs/range.md eq. (3)."""
        told, now = self._core.gauge_sigma(True), self._core.gauge_sigma(False)  # noqa: FBT003
        return Observability(gauge_sigma_told=told, gauge_sigma=now, determined=self._core.determined_directions)

    def predicted_gain(self, T_camera_target: Matrix4, sigma_px: float = 1.0) -> float:
        """What a view of all landmarks from this pose would add to the information about the model [nats], eq. (4)."""
        return self._core.predicted_gain(np.ascontiguousarray(T_camera_target)[None], sigma_px)

    @property
    def ranges_believed(self) -> int:
        """Readings of the range finder that were used so far."""
        return self._core.ranges_believed

    @property
    def ranges_refused(self) -> int:
        """Readings that did not agree with the others, or came too late."""
        return self._core.ranges_refused

    @property
    def noise_factor(self) -> float:
        """Estimated ratio of the true to the told pixel covariances [-], docs/estimator.md eq. (14)."""
        return self._core.noise_factor

    @property
    def prior_factor(self) -> float:
        """Estimated ratio of the true to the told model covariance [-], docs/estimator.md eq. (16)."""
        return self._core.prior_factor


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
    """Negative log posterior at the optimum [-]."""
    iterations: int
    converged: bool

    @property
    def reprojection_rms_px(self) -> float:
        """Root mean square over both coordinates of all inliers [px]."""
        n = sum(e.n_inliers for e in self.estimates if e.ok)
        squares = sum(e.n_inliers * e.reprojection_rms_px**2 for e in self.estimates if e.ok and e.n_inliers)
        return float(np.sqrt(squares / n)) if n else float("nan")


def refine(views: Iterable[View], target: Target, camera: Camera, options: TrackerOptions | None = None) -> Refinement:
    """All views of a flight in one maximum a posteriori estimate of landmarks and poses, docs/estimator.md section 5.

    Same unknowns, residuals and prior as `Tracker`, nothing marginalised. Raises ValueError as `Tracker` does.
    """
    views = tuple(views)
    index = LandmarkIndex(target.landmarks)
    sizes = np.array([len(view.landmarks) for view in views], dtype=np.int32)
    estimates, X, P, noise, prior, believed, cost, iterations, converged = _core.refine(
        core_camera(camera),
        target.positions,
        target.covariance,
        np.array([view.stamp_ns for view in views], dtype=np.int64),
        sizes,
        np.concatenate([index(view.landmarks) for view in views] or [np.empty(0, np.int32)]),
        np.concatenate([view.pixels for view in views] or [np.empty((0, 2))]),
        np.concatenate([view.covariances for view in views] or [np.empty((0, 2, 2))]),
        (options or TrackerOptions()).to_core(),
    )
    return Refinement(
        estimates=tuple(_estimate(view.frame, e, target.landmarks) for view, e in zip(views, estimates, strict=True)),
        model=replace(target, positions=X, covariance=P),
        noise_factor=noise,
        prior_factor=prior,
        prior_factor_believed=believed,
        cost=cost,
        iterations=iterations,
        converged=converged,
    )
