# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What the wrappers of the core share: options, names to numbers, records."""

import difflib
import reprlib
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np

from fairlead import _core
from fairlead.types import Camera, Estimate, Target
from fairlead.types.checks import instance

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
    correlation_angle_rad: float = _D.correlation_angle_rad
    """The same by the turn of the line of sight in the target frame [rad]; 0: it makes no difference."""
    correlation_log_range: float = _D.correlation_log_range
    """The same by the logarithm of the range [-]; 0: it makes no difference."""
    design_effect: float = _D.design_effect
    """So many times more errs the pose of a view, squared, since its landmarks err alike [-], docs/motion.md (16)."""
    range_to_origin: bool = _D.range_to_origin
    """Whether readings of the range to the target's origin will come, docs/range.md."""
    range_bias_sigma_m: float = _D.range_bias_sigma_m
    """What the range finder may always read too much, one standard deviation [m]; above 0 it is estimated,
    docs/range.md eq. (5)."""
    seed: int = _D.seed
    """Of the consensus search."""

    def to_core(self) -> _core.TrackerOptions:
        """The same options as the core's record. Raises ValueError for a value of another type, naming the option."""
        options = _core.TrackerOptions()
        for name, value in asdict(self).items():
            try:
                setattr(options, name, value)
            except TypeError:
                expected = _expected(getattr(_D, name), value)
                raise ValueError(f"{name}: got {reprlib.repr(value)}, expected {expected}") from None
        return options

    def check(self) -> None:
        """Raises ValueError for an option out of range, as `Tracker` does: the ranges are the core's alone."""
        _core.Tracker(core_camera(_ANY_CAMERA), np.eye(4, 3), np.eye(12), self.to_core())


def _expected(default: object, value: object) -> str:
    """What an option takes, in words; `value` is what the core did not take."""
    if isinstance(default, bool):
        return "true or false"
    if isinstance(default, str):
        return "text"
    if isinstance(default, float):
        return "a number"
    if isinstance(value, int):
        return "a whole number >= 0" if value < 0 else "a smaller whole number"
    return "a whole number"


_ANY_CAMERA = Camera(name="any", width=1, height=1, model="pinhole", K=np.eye(3), distortion=np.empty(0))


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

    def point(self, name: str | None) -> int:
        """Number of a landmark, or what stands for the target's origin."""
        return _core.ORIGIN if name is None else int(self([name])[0])


def options_for(target: Target, camera: Camera, options: TrackerOptions | None) -> TrackerOptions:
    """The options, or the defaults; the target's own motion holds where they say nothing.

    Raises ValueError if one of the three is something else.
    """
    options = TrackerOptions() if options is None else options
    instance(target, Target, "target")
    instance(camera, Camera, "camera")
    instance(options, TrackerOptions, "options")
    motion = target.motion
    if motion is None or options.motion != "none":
        return options
    return replace(options, motion=motion.kind, jerk_density_m_s25=motion.jerk_density_m_s25)


CoreEstimate = tuple[int, str, str, np.ndarray, np.ndarray, int, int, float, float, int, list[int]]


def to_estimate(frame: int, core: CoreEstimate, landmarks: Sequence[str]) -> Estimate:
    """The core's answer as the package's record."""
    stamp_ns, status, reason, T, covariance, n_inliers, n_dropped, rms, information, resets, inliers = core
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
        n_dropped=n_dropped,
    )
