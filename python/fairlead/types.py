# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Records that travel between the boxes, and the array aliases of their fields.

Every array is copied to float64 and set read-only; a record is never changed. Conventions: CONVENTIONS.md.
"""

import operator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, Protocol, SupportsIndex, get_args

import numpy as np
from jaxtyping import Float64
from numpy.typing import ArrayLike

Points3 = Float64[np.ndarray, "n 3"]
"""Points, one a row [m]."""
Pixels = Float64[np.ndarray, "n 2"]
"""Image points, one a row [px]; (0, 0) is the centre of the top-left pixel."""
PixelCovariances = Float64[np.ndarray, "n 2 2"]
"""Covariance of each image point [px^2]."""
Rays = Float64[np.ndarray, "n 3"]
"""Unit directions in the camera frame."""
Vector3 = Float64[np.ndarray, "3"]
Vector4 = Float64[np.ndarray, "4"]
Vector6 = Float64[np.ndarray, "6"]
Matrix3 = Float64[np.ndarray, "3 3"]
Matrix4 = Float64[np.ndarray, "4 4"]
Matrix6 = Float64[np.ndarray, "6 6"]
Poses = Float64[np.ndarray, "k 4 4"]
"""Rigid motions, one a block."""
Scores = Float64[np.ndarray, "n"]
Distortion = Float64[np.ndarray, "d"]
ModelCovariance = Float64[np.ndarray, "m m"]
"""Joint covariance of all landmarks, landmark after landmark, x y z each [m^2]; m = 3 n."""

CameraModel = Literal["pinhole", "plumb_bob", "rational_polynomial", "equidistant"]
Status = Literal["acquiring", "tracking", "coasting", "lost"]
MotionKind = Literal["range", "target", "world", "none"]

DISTORTION_SIZE: dict[CameraModel, int] = {"pinhole": 0, "plumb_bob": 5, "rational_polynomial": 8, "equidistant": 4}
"""Number of distortion coefficients of each camera model, docs/cameras.md."""

RIGID_TOLERANCE = 1e-6
"""Largest deviation of R^T R from I that still counts as a rotation [-]."""


def frozen_array(values: ArrayLike, shape: tuple[int, ...], name: str) -> np.ndarray:
    """Copy to a read-only float64 array of this shape; ValueError names the field otherwise."""
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name}: expected numbers of shape {shape}, got {type(values).__name__}") from error
    if array.shape != shape:
        raise ValueError(f"{name}: expected shape {shape}, got {array.shape}")
    array.setflags(write=False)
    return array


def _integer(value: SupportsIndex, name: str) -> int:
    try:
        integer = operator.index(value)
    except TypeError as error:
        raise ValueError(f"{name}: expected an integer, got {value!r}") from error
    if not -(2**63) <= integer < 2**63:
        raise ValueError(f"{name}: expected a 64-bit integer, got {integer}")
    return integer


def _names(values: tuple[str, ...], name: str) -> tuple[str, ...]:
    names = tuple(values)
    for value in names:
        if not isinstance(value, str) or not value:  # pyright: ignore[reportUnnecessaryIsInstance]
            raise ValueError(f"{name}: expected non-empty text, got {value!r}")
    return names


def _finite(array: np.ndarray, name: str) -> None:
    if not np.isfinite(array).all():
        raise ValueError(f"{name}: expected finite numbers, got {array.tolist()}")


def _choice(value: str, allowed: tuple[str, ...], name: str) -> None:
    if value not in allowed:
        raise ValueError(f"{name}: expected one of {', '.join(allowed)}, got {value!r}")


def is_covariance(matrix: np.ndarray, tolerance: float = 1e-9) -> bool:
    """Finite, symmetric and positive semidefinite, judged on the correlations, so that units may be mixed.

    Variances below 1e-14 of the largest count as zero; the smallest eigenvalue may be -tolerance x size.
    """
    variances = np.diag(matrix)
    if not np.isfinite(matrix).all() or variances.min(initial=0.0) < 0.0:
        return False
    largest = float(variances.max(initial=0.0))
    if largest == 0.0:
        return not matrix.any()
    scale = np.sqrt(variances + 1e-14 * largest)
    correlations = matrix / np.outer(scale, scale)
    if np.abs(correlations - correlations.T).max() > tolerance:
        return False
    try:
        np.linalg.cholesky(correlations + tolerance * matrix.shape[0] * np.eye(matrix.shape[0]))
    except np.linalg.LinAlgError:
        return False
    return True


def is_rigid(T: np.ndarray, tolerance: float = RIGID_TOLERANCE) -> bool:
    """R^T R = I and det R = +1 to `tolerance`, last row 0 0 0 1, finite."""
    if not np.isfinite(T).all() or not np.array_equal(T[3], [0.0, 0.0, 0.0, 1.0]):
        return False
    R = T[:3, :3]
    return bool(np.abs(R.T @ R - np.eye(3)).max() <= tolerance and np.linalg.det(R) > 0.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Camera:
    """A calibrated central camera, docs/cameras.md eq. (1)-(6).

    Raises ValueError for an empty image, a focal length that is not positive, skew, or a wrong number of coefficients.
    """

    name: str
    width: int
    """Image width [px]."""
    height: int
    """Image height [px]."""
    model: CameraModel
    K: Matrix3
    """[[fx, 0, cx], [0, fy, cy], [0, 0, 1]] [px]."""
    distortion: Distortion
    """plumb_bob k1 k2 p1 p2 k3; rational_polynomial k1 k2 p1 p2 k3 k4 k5 k6; equidistant k1 k2 k3 k4; pinhole none."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "width", _integer(self.width, "camera width"))
        object.__setattr__(self, "height", _integer(self.height, "camera height"))
        if self.width <= 0 or self.height <= 0:
            raise ValueError(f"camera size: expected positive width and height, got {self.width} x {self.height}")
        _choice(self.model, get_args(CameraModel), "camera model")
        K = frozen_array(self.K, (3, 3), "camera K")
        _finite(K, "camera K")
        if K[0, 0] <= 0.0 or K[1, 1] <= 0.0:
            raise ValueError(f"camera K: expected positive focal lengths, got {K[0, 0]} and {K[1, 1]}")
        if K[0, 1] != 0.0 or K[1, 0] != 0.0 or K[2].tolist() != [0.0, 0.0, 1.0]:
            raise ValueError(f"camera K: expected [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], got {K.tolist()}")
        distortion = frozen_array(self.distortion, (DISTORTION_SIZE[self.model],), f"distortion of {self.model}")
        _finite(distortion, "camera distortion")
        object.__setattr__(self, "K", K)
        object.__setattr__(self, "distortion", distortion)


@dataclass(frozen=True, kw_only=True)
class KnownDistance:
    """A measured distance between two landmarks."""

    between: tuple[str, str]
    length_m: float
    sigma_m: float

    def __post_init__(self) -> None:
        names = _names(self.between, "distance between")
        if len(names) != 2 or names[0] == names[1]:
            raise ValueError(f"distance between: expected two different landmarks, got {names}")
        if not (np.isfinite(self.length_m) and self.length_m > 0.0):
            raise ValueError(f"distance length_m: expected a positive number, got {self.length_m}")
        if not (np.isfinite(self.sigma_m) and self.sigma_m > 0.0):
            raise ValueError(f"distance sigma_m: expected a positive number, got {self.sigma_m}")


@dataclass(frozen=True, kw_only=True)
class MotionPrior:
    """White noise on jerk, in the quantity that is really smooth."""

    kind: MotionKind
    jerk_density_m_s25: float
    """Root of the power spectral density of jerk [m/s^2.5]."""

    def __post_init__(self) -> None:
        _choice(self.kind, get_args(MotionKind), "motion kind")
        if not (np.isfinite(self.jerk_density_m_s25) and self.jerk_density_m_s25 >= 0.0):
            raise ValueError(f"motion jerk_density_m_s25: expected a number >= 0, got {self.jerk_density_m_s25}")


@dataclass(frozen=True, kw_only=True, eq=False)
class Target:
    """The landmark model: X ~ N(X0, P0) in the target frame.

    P0 = diag(sigma_j^2) + scale_sigma^2 x0 x0^T with x0 the positions about their centroid, or the posterior
    covariance of a refined model. Raises ValueError for duplicate names, numbers that are not finite, a covariance that
    is not symmetric positive semidefinite, or a distance between landmarks that do not exist.
    """

    name: str
    landmarks: tuple[str, ...]
    positions: Points3
    """X0 [m]."""
    covariance: ModelCovariance
    """P0 [m^2], landmark after landmark, x y z each."""
    mesh: Path | None = None
    """Surface, vertices in metres."""
    touchdown: Vector3 | None = None
    """The point whose position a landing needs [m]."""
    distances: tuple[KnownDistance, ...] = ()
    motion: MotionPrior | None = None

    def __post_init__(self) -> None:
        names = _names(self.landmarks, "target landmarks")
        if len(set(names)) != len(names):
            twice = next(name for name in names if names.count(name) > 1)
            raise ValueError(f"target landmarks: expected different names, got {twice!r} more than once")
        n = len(names)
        positions = frozen_array(self.positions, (n, 3), "target positions")
        _finite(positions, "target positions")
        covariance = frozen_array(self.covariance, (3 * n, 3 * n), "target covariance")
        if not is_covariance(covariance):
            raise ValueError("target covariance: expected a finite, symmetric, positive semidefinite matrix")
        for distance in self.distances:
            for landmark in distance.between:
                if landmark not in names:
                    raise ValueError(f"distance between: no landmark is named {landmark!r}")
        if self.touchdown is not None:
            object.__setattr__(self, "touchdown", frozen_array(self.touchdown, (3,), "target touchdown"))
            _finite(np.asarray(self.touchdown), "target touchdown")
        object.__setattr__(self, "landmarks", names)
        object.__setattr__(self, "positions", positions)
        object.__setattr__(self, "covariance", covariance)
        object.__setattr__(self, "distances", tuple(self.distances))


@dataclass(frozen=True, kw_only=True, eq=False)
class View:
    """The observations of one image. Numbers that are not finite are allowed here: the estimator drops them."""

    frame: int
    """Number of the image."""
    stamp_ns: int
    landmarks: tuple[str, ...]
    pixels: Pixels
    covariances: PixelCovariances
    scores: Scores | None = None
    """Confidence of the detector, as it came [-]."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "frame", _integer(self.frame, "view frame"))
        object.__setattr__(self, "stamp_ns", _integer(self.stamp_ns, "view stamp_ns"))
        names = _names(self.landmarks, "view landmarks")
        n = len(names)
        object.__setattr__(self, "landmarks", names)
        object.__setattr__(self, "pixels", frozen_array(self.pixels, (n, 2), "view pixels"))
        object.__setattr__(self, "covariances", frozen_array(self.covariances, (n, 2, 2), "view covariances"))
        if self.scores is not None:
            object.__setattr__(self, "scores", frozen_array(self.scores, (n,), "view scores"))


@dataclass(frozen=True, kw_only=True, eq=False)
class Estimate:
    """What one update returns. Unless `ok`, the pose and its covariance are NaN and `reason` says why."""

    frame: int
    stamp_ns: int
    status: Status
    reason: str
    """Empty if there is none."""
    T_camera_target: Matrix4
    """p_camera = T_camera_target p_target, frame of the prior model."""
    covariance: Matrix6
    """Of xi = (rho, phi) in T Exp(xi): target axes [m, rad], gauge uncertainty included."""
    n_inliers: int
    reprojection_rms_px: float
    information_gained: float
    """Decrease of the entropy of the landmark model by this view [nat]."""
    reset_counter: int
    """Increments when the pose jumps."""
    inliers: tuple[str, ...]

    def __post_init__(self) -> None:
        for name in ("frame", "stamp_ns", "n_inliers", "reset_counter"):
            object.__setattr__(self, name, _integer(getattr(self, name), f"estimate {name}"))
        _choice(self.status, get_args(Status), "estimate status")
        T = frozen_array(self.T_camera_target, (4, 4), "estimate T_camera_target")
        covariance = frozen_array(self.covariance, (6, 6), "estimate covariance")
        if self.ok and not is_rigid(T):
            raise ValueError(f"estimate T_camera_target: expected a rigid motion, got {T.tolist()}")
        if self.ok and not is_covariance(covariance):
            raise ValueError("estimate covariance: expected a finite, symmetric, positive semidefinite matrix")
        if not self.ok and not (np.isnan(T).all() and np.isnan(covariance).all()):
            raise ValueError(f"estimate: expected NaN pose and covariance where the status is {self.status}")
        object.__setattr__(self, "T_camera_target", T)
        object.__setattr__(self, "covariance", covariance)
        object.__setattr__(self, "inliers", _names(self.inliers, "estimate inliers"))

    @property
    def ok(self) -> bool:
        """Whether there is a pose: status tracking or coasting."""
        return self.status in ("tracking", "coasting")


@dataclass(frozen=True, kw_only=True, eq=False)
class TruthPose:
    """A pose known from elsewhere."""

    frame: int
    stamp_ns: int
    T_camera_target: Matrix4

    def __post_init__(self) -> None:
        object.__setattr__(self, "frame", _integer(self.frame, "truth frame"))
        object.__setattr__(self, "stamp_ns", _integer(self.stamp_ns, "truth stamp_ns"))
        T = frozen_array(self.T_camera_target, (4, 4), "truth T_camera_target")
        if not is_rigid(T):
            raise ValueError(f"truth T_camera_target: expected a rigid motion, got {T.tolist()}")
        object.__setattr__(self, "T_camera_target", T)


class PoseEstimator(Protocol):
    """What `map`, `window` and `epnp` share: a view in, an estimate out; bad data never raise."""

    def update(self, view: View) -> Estimate:
        """Take in one view; the estimate says whether there is a pose."""
        ...

    @property
    def model(self) -> Target:
        """The landmark model as it is now."""
        ...
