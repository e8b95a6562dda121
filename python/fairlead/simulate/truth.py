# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""One simulated flight: what is true and what the estimator is told."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64

from fairlead import geometry
from fairlead.cameras import MIN_DEPTH_M
from fairlead.types import (
    AttitudeReading,
    Camera,
    ModelCovariance,
    Points3,
    Poses,
    RangeReading,
    Target,
    TruthPose,
    View,
)


def project_all(camera: Camera, X: Points3, T_camera_target: Poses) -> np.ndarray:
    """z_kj = pi(T_k X_j), (k, n, 2) [px]; NaN where a landmark is behind the camera."""
    p = np.einsum("kij,nj->kni", T_camera_target[:, :3, :3], X) + T_camera_target[:, None, :3, 3]
    if camera.model != "equidistant" and not camera.distortion.any():
        return _pinhole(camera, p)
    return geometry.project(camera, p.reshape(-1, 3)).reshape(len(T_camera_target), len(X), 2)


def _pinhole(camera: Camera, p: Float64[np.ndarray, "k n 3"]) -> Float64[np.ndarray, "k n 2"]:
    """What geometry.project does without distortion, to the last bit; most of a study's flights are made here."""
    with np.errstate(all="ignore"):
        pixels = p[..., :2] / p[..., 2:] * np.diag(camera.K)[:2] + camera.K[:2, 2]
        pixels[~(p[..., 2] >= MIN_DEPTH_M) | ~np.isfinite(p).all(axis=2)] = np.nan
    return pixels


@dataclass(frozen=True, kw_only=True, eq=False)
class Simulation:
    """Truth (`target_true`, `T_true`) and what is told (all others). An estimator gets the latter only."""

    camera: Camera
    target_told: Target
    """X0 and the P0 that the estimator is to believe."""
    views: tuple[View, ...]
    target_true: Target
    """The true landmarks, without uncertainty."""
    T_true: Poses
    """(k, 4, 4) T_camera_target, order as in `views`."""
    ranges: tuple[RangeReading, ...] = ()
    """In order of time."""
    attitudes: tuple[AttitudeReading, ...] = ()
    """In order of time."""

    @property
    def X_true(self) -> Points3:
        """(n, 3) [m], order as in the target."""
        return self.target_true.positions

    @property
    def truth(self) -> tuple[TruthPose, ...]:
        """The true pose of every view."""
        return tuple(
            TruthPose(frame=view.frame, stamp_ns=view.stamp_ns, T_camera_target=T)
            for view, T in zip(self.views, self.T_true, strict=True)
        )

    @property
    def views_true(self) -> tuple[View, ...]:
        """Where the landmarks really are in each image, hidden ones too, without error; those outside are left out."""
        pixels = project_all(self.camera, self.X_true, self.T_true)
        views: list[View] = []
        for view, z in zip(self.views, pixels, strict=True):
            with np.errstate(invalid="ignore"):
                inside = ((z >= -0.5) & (z <= np.array([self.camera.width, self.camera.height]) - 0.5)).all(axis=1)
            names = tuple(name for name, keep in zip(self.target_true.landmarks, inside, strict=True) if keep)
            covariances = np.zeros((len(names), 2, 2))
            views.append(replace(view, landmarks=names, pixels=z[inside], covariances=covariances, scores=None))
        return tuple(views)


def known_exactly(target: Target) -> Target:
    """The same landmarks with no uncertainty."""
    return replace(target, covariance=np.zeros_like(target.covariance))


def roughly_known(target: Target, positions: Points3, covariance: ModelCovariance) -> Target:
    """What is told of a target: rough landmarks and their covariance, and no touchdown point that only truth knows."""
    return replace(target, positions=positions, covariance=covariance, touchdown=None)
