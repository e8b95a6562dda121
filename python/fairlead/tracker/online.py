# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""One view after the other (mode `map`). docs/estimator.md."""

from dataclasses import dataclass, replace

import numpy as np

from fairlead import _core
from fairlead.tracker.core import LandmarkIndex, TrackerOptions, core_camera, options_for, to_estimate
from fairlead.types import AttitudeReading, Camera, Estimate, Matrix3, Matrix4, Matrix6, RangeReading, Target, View
from fairlead.types.checks import frozen_array, instance, integer, number


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
        options = options_for(target, camera, options)
        self._target = target
        self._index = LandmarkIndex(target.landmarks)
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
        reading = RangeReading(stamp_ns=stamp_ns, range_m=range_m, sigma_m=sigma_m, landmark=landmark)
        self._core.add_range(reading.stamp_ns, reading.range_m, reading.sigma_m, self._index.point(landmark))

    def add_attitude(self, stamp_ns: int, R_world_camera: Matrix3, sigma_rad: float) -> None:
        """The camera's attitude in a world-aligned frame at a view's stamp, for motion `world`, docs/motion.md.

        Raises ValueError unless it is a rotation.
        """
        reading = AttitudeReading(stamp_ns=stamp_ns, R_world_camera=R_world_camera, sigma_rad=sigma_rad)
        self._core.add_attitude(reading.stamp_ns, reading.R_world_camera, reading.sigma_rad)

    def add_pose(self, stamp_ns: int, T_camera_target: Matrix4, covariance: Matrix6) -> None:
        """Where the target is thought to be while it is not tracked: the search of the next view starts there.

        Raises ValueError unless it is a rigid motion with a positive definite covariance of xi in T Exp(xi).
        """
        T = frozen_array(T_camera_target, (4, 4), "pose T_camera_target")
        P = frozen_array(covariance, (6, 6), "pose covariance")
        self._core.add_pose(integer(stamp_ns, "pose stamp_ns"), T[None], P)

    def update(self, view: View) -> Estimate:
        """Take in one view; bad data end in the status, never in an exception.

        Raises ValueError only if it is no View, or names a landmark that the target does not have.
        """
        instance(view, View, "view")
        core = self._core.update(view.stamp_ns, self._index(view.landmarks), view.pixels, view.covariances)
        return to_estimate(view.frame, core, self._target.landmarks)

    def predict(self, stamp_ns: int) -> Estimate:
        """Where the target will be, from the views so far: nothing is changed. `frame` is -1, that of no image.

        T Exp(v dt) with the pose's rate v over the last half second or so, and the covariance of
        docs/estimator.md eq. (20). Status `coasting`; not ok where nothing is tracked, the stamp is before the last
        view's, or further ahead than `TrackerOptions.coast_limit_s`.
        """
        return to_estimate(-1, self._core.predict(integer(stamp_ns, "stamp_ns")), self._target.landmarks)

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
        T = frozen_array(T_camera_target, (4, 4), "T_camera_target")
        return self._core.predicted_gain(T[None], number(sigma_px, "sigma_px"))

    @property
    def ranges_believed(self) -> int:
        """Readings of the range finder that were used so far."""
        return self._core.ranges_believed

    @property
    def ranges_refused(self) -> int:
        """Readings that did not agree with the others, or came too late."""
        return self._core.ranges_refused

    @property
    def range_bias(self) -> tuple[float, float]:
        """What the range finder always reads too much, and one standard deviation of it [m]; docs/range.md eq. (5).

        Zeros without `TrackerOptions.range_bias_sigma_m`.
        """
        return self._core.range_bias

    @property
    def noise_factor(self) -> float:
        """Estimated ratio of the true to the told pixel covariances [-], docs/estimator.md eq. (14)."""
        return self._core.noise_factor

    @property
    def prior_factor(self) -> float:
        """Estimated ratio of the true to the told model covariance [-], docs/estimator.md eq. (16)."""
        return self._core.prior_factor
