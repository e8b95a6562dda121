# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Camera and target: what is known before the first image."""

from dataclasses import dataclass
from pathlib import Path
from typing import get_args

import numpy as np

from fairlead.types.arrays import (
    DISTORTION_SIZE,
    CameraModel,
    Distortion,
    Matrix3,
    ModelCovariance,
    MotionKind,
    Points3,
    Vector3,
)
from fairlead.types.checks import assign, choice, finite, frozen_array, integer, is_covariance, names, positive


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
        assign(self, width=integer(self.width, "camera width"), height=integer(self.height, "camera height"))
        if self.width <= 0 or self.height <= 0:
            raise ValueError(f"camera size: expected positive width and height, got {self.width} x {self.height}")
        choice(self.model, get_args(CameraModel), "camera model")
        K = frozen_array(self.K, (3, 3), "camera K")
        finite(K, "camera K")
        if K[0, 0] <= 0.0 or K[1, 1] <= 0.0:
            raise ValueError(f"camera K: expected positive focal lengths, got {K[0, 0]} and {K[1, 1]}")
        if K[0, 1] != 0.0 or K[1, 0] != 0.0 or K[2].tolist() != [0.0, 0.0, 1.0]:
            raise ValueError(f"camera K: expected [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], got {K.tolist()}")
        distortion = frozen_array(self.distortion, (DISTORTION_SIZE[self.model],), f"distortion of {self.model}")
        finite(distortion, "camera distortion")
        assign(self, K=K, distortion=distortion)


@dataclass(frozen=True, kw_only=True)
class KnownDistance:
    """A measured distance between two landmarks. Raises ValueError for one landmark or numbers not above 0."""

    between: tuple[str, str]
    length_m: float
    sigma_m: float

    def __post_init__(self) -> None:
        landmarks = names(self.between, "distance between")
        if len(landmarks) != 2 or landmarks[0] == landmarks[1]:
            raise ValueError(f"distance between: expected two different landmarks, got {landmarks}")
        positive(self.length_m, "distance length_m")
        positive(self.sigma_m, "distance sigma_m")


@dataclass(frozen=True, kw_only=True)
class MotionPrior:
    """White noise on jerk, in the quantity that is really smooth."""

    kind: MotionKind
    jerk_density_m_s25: float
    """Root of the power spectral density of jerk [m/s^2.5]."""

    def __post_init__(self) -> None:
        choice(self.kind, get_args(MotionKind), "motion kind")
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
        landmarks = names(self.landmarks, "target landmarks")
        if len(set(landmarks)) != len(landmarks):
            twice = next(name for name in landmarks if landmarks.count(name) > 1)
            raise ValueError(f"target landmarks: expected different names, got {twice!r} more than once")
        n = len(landmarks)
        positions = frozen_array(self.positions, (n, 3), "target positions")
        finite(positions, "target positions")
        covariance = frozen_array(self.covariance, (3 * n, 3 * n), "target covariance")
        if not is_covariance(covariance):
            raise ValueError("target covariance: expected a finite, symmetric, positive semidefinite matrix")
        for distance in self.distances:
            for landmark in distance.between:
                if landmark not in landmarks:
                    raise ValueError(f"distance between: no landmark is named {landmark!r}")
        if self.touchdown is not None:
            assign(self, touchdown=frozen_array(self.touchdown, (3,), "target touchdown"))
            finite(np.asarray(self.touchdown), "target touchdown")
        assign(self, landmarks=landmarks, positions=positions, covariance=covariance, distances=tuple(self.distances))
