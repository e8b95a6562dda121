# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""One simulated flight: what is true and what the estimator is told."""

from dataclasses import dataclass, replace

import numpy as np

from fairlead import geometry
from fairlead.types import Camera, Points3, Poses, Target, TruthPose, View


def project_all(camera: Camera, X: Points3, T_camera_target: Poses) -> np.ndarray:
    """z_kj = pi(T_k X_j), (k, n, 2) [px]; NaN where a landmark is behind the camera."""
    p = np.einsum("kij,nj->kni", T_camera_target[:, :3, :3], X) + T_camera_target[:, None, :3, 3]
    return geometry.project(camera, p.reshape(-1, 3)).reshape(len(T_camera_target), len(X), 2)


@dataclass(frozen=True, kw_only=True, eq=False)
class Simulation:
    """Truth (`X_true`, `T_true`) and what is told (`target_told`, `views`). An estimator gets the latter only."""

    camera: Camera
    target_told: Target
    """X0 and the P0 that the estimator is to believe."""
    views: tuple[View, ...]
    X_true: Points3
    """(n, 3) [m], order as in the target."""
    T_true: Poses
    """(k, 4, 4) T_camera_target, order as in `views`."""

    @property
    def target_true(self) -> Target:
        """The target with its true landmarks and no uncertainty."""
        return replace(
            self.target_told,
            positions=self.X_true,
            covariance=np.zeros_like(self.target_told.covariance),
            touchdown=None,
        )

    @property
    def truth(self) -> tuple[TruthPose, ...]:
        """The true pose of every view."""
        return tuple(
            TruthPose(frame=view.frame, stamp_ns=view.stamp_ns, T_camera_target=T)
            for view, T in zip(self.views, self.T_true, strict=True)
        )
