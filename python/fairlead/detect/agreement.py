# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Whether keypoints agree with one pose of the rough model, docs/detect.md section 5."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool

from fairlead.detect.keypoints import Keypoints
from fairlead.detect.window import Window
from fairlead.geometry import project, transform
from fairlead.pnp import INLIER, MIN_POINTS, robust_pose, whitened_squares
from fairlead.types import Camera, Matrix4, Matrix6, PixelCovariances, Points3, Target

_GUESS = 0.02
"""Model error of the first search, share of the keypoints' spread: their distance is not known yet."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RoughModel:
    """The landmarks that the network knows, in its order, and how well the target knows them."""

    names: tuple[str, ...]
    X_target: Points3
    """NaN for landmarks that the target does not have [m]."""
    sigma_m: np.ndarray
    """(n,) root mean square over the three axes [m]."""
    camera: Camera

    @property
    def known(self) -> Bool[np.ndarray, "n"]:
        """Which are the target's."""
        return np.isfinite(self.X_target[:, 0])

    def errors_px(self, T_camera_target: Matrix4) -> np.ndarray:
        """(n,) standard deviation that the model's errors make in the image [px]: f sigma / depth."""
        depth = transform(T_camera_target, self.X_target)[:, 2]
        focal = float(np.sqrt(self.camera.K[0, 0] * self.camera.K[1, 1]))
        return focal * self.sigma_m / np.maximum(depth, 1e-3)


def rough_model(target: Target, names: tuple[str, ...], camera: Camera) -> RoughModel:
    """Of the landmarks of a network. Raises ValueError if the target has fewer than four of them."""
    rows = {name: row for row, name in enumerate(target.landmarks)}
    X, sigma = np.full((len(names), 3), np.nan), np.zeros(len(names))
    variances = np.diag(target.covariance).reshape(-1, 3).mean(axis=1)
    for j, name in enumerate(names):
        if name in rows:
            X[j], sigma[j] = target.positions[rows[name]], np.sqrt(variances[rows[name]])
    if np.count_nonzero(np.isfinite(X[:, 0])) < MIN_POINTS:
        theirs, ours = ", ".join(names[:4]), ", ".join(target.landmarks[:4])
        raise ValueError(f"expected the landmarks of target {target.name} ({ours} ...), got {theirs} ...")
    return RoughModel(names=names, X_target=X, sigma_m=sigma, camera=camera)


@dataclass(frozen=True, kw_only=True, eq=False)
class Agreement:
    """A pose, and what of the keypoints it explains."""

    T_camera_target: Matrix4
    covariance: Matrix6
    """Of the inliers' pixels, the model's errors included; xi of T Exp(xi)."""
    inliers: Bool[np.ndarray, "n"]
    score: float
    """Inliers over landmarks that the pose puts into the window, each by how surely it is seen, eq. (8)."""


def agreement(
    model: RoughModel, keypoints: Keypoints, seen: Bool[np.ndarray, "n"], window: Window, weights: np.ndarray
) -> Agreement | None:
    """The pose that most of the seen keypoints (image pixels) agree with; None if there is none.

    Their covariances are widened by the model's errors, docs/detect.md eq. (7). `weights` (n,) are from 0 to 1.
    """
    rows = np.flatnonzero(seen & model.known)
    if len(rows) < MIN_POINTS:
        return None
    X, z, S = model.X_target[rows], keypoints.pixels[rows], keypoints.covariances[rows]
    spread = float(np.linalg.norm(np.ptp(z, axis=0)))
    first = robust_pose(X, z, _widened(S, np.full(len(rows), _GUESS * spread)), model.camera)
    if first is None:
        return None
    wide = _widened(S, model.errors_px(first.T_camera_target)[rows])
    pose = robust_pose(X, z, wide, model.camera)
    if pose is None or np.linalg.eigvalsh(pose.information)[0] <= 0.0:
        return None
    inliers = np.zeros(len(model.names), dtype=bool)
    inliers[rows] = pose.inliers
    expected = inside(window, project(model.camera, transform(pose.T_camera_target, model.X_target)))
    return Agreement(
        T_camera_target=pose.T_camera_target,
        covariance=np.linalg.inv(pose.information),
        inliers=inliers,
        score=float(weights[inliers].sum() / max(1, np.count_nonzero(expected | inliers))),
    )


def agrees_with_prediction(
    model: RoughModel, keypoints: Keypoints, seen: Bool[np.ndarray, "n"], T_camera_target: Matrix4, margin_px: float
) -> bool:
    """Whether most of the seen keypoints lie where a predicted pose puts them, for fewer than a pose needs."""
    rows = np.flatnonzero(seen & model.known)
    if len(rows) == 0:
        return False
    sigmas = np.hypot(model.errors_px(T_camera_target)[rows], margin_px)
    wide = _widened(keypoints.covariances[rows], sigmas)
    squares = whitened_squares(model.X_target[rows], keypoints.pixels[rows], wide, model.camera, T_camera_target)
    return bool(np.count_nonzero(squares < INLIER) > 0.5 * len(rows))


def inside(window: Window, pixels: np.ndarray) -> Bool[np.ndarray, "n"]:
    """Which pixels of the image lie in the window; NaN do not."""
    z = window.to_crop(pixels)
    with np.errstate(invalid="ignore"):
        return np.all((z > -0.5) & (z < np.array(window.size) - 0.5), axis=1)


def _widened(covariances: PixelCovariances, sigmas_px: np.ndarray) -> PixelCovariances:
    return covariances + sigmas_px[:, None, None] ** 2 * np.eye(2)
