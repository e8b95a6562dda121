# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Where to look next: the projected model under the predicted pose, docs/detect.md section 7."""

from dataclasses import dataclass

import numpy as np

from fairlead.geometry import exp_se3, project, transform
from fairlead.types import Camera, Matrix4, Matrix6, Points3

HOLD_S = 1.0
"""A pose older than this predicts nothing."""
SHAKE_RAD_S2 = 0.1
"""Angular acceleration of a camera that nothing has been seen of yet: the least that the margin allows for."""
MAX_GROWTH = 1.6
"""The margin never makes the square larger than this times the padded box: networks know only so many scales."""
_NS = 1e-9


@dataclass(frozen=True, kw_only=True, eq=False)
class Prediction:
    """The pose at the stamp of an image that has not been looked at yet."""

    T_camera_target: Matrix4
    covariance: Matrix6
    age_s: float
    """Since the last pose."""


@dataclass(frozen=True, kw_only=True)
class Region:
    """A square in the image."""

    middle: tuple[float, float]
    side: float
    margin_px: float
    """How far the target may be from where it is expected."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Known:
    stamp_ns: int
    T_camera_target: Matrix4
    covariance: Matrix6


class Follower:
    """Keeps the last two poses, extrapolates, and remembers how wrong it was."""

    def __init__(self, X_target: Points3, camera: Camera, pad: float) -> None:
        self._X, self._camera, self._pad = X_target, camera, pad
        self._last: _Known | None = None
        self._before: _Known | None = None
        self._surprise_px = 0.0

    def note(self, stamp_ns: int, T_camera_target: Matrix4, covariance: Matrix6) -> None:
        """A pose was found at this stamp; a second one for the same stamp replaces the first, an older one is late."""
        if self._last is not None and stamp_ns < self._last.stamp_ns:
            return
        known = _Known(stamp_ns=stamp_ns, T_camera_target=T_camera_target, covariance=covariance)
        if self._last is not None and stamp_ns > self._last.stamp_ns:
            expected = self.predict(stamp_ns)
            if expected is not None:
                self._learn(expected, T_camera_target)
            self._before = self._last
        self._last = known

    def _learn(self, expected: Prediction, T_camera_target: Matrix4) -> None:
        """The margin follows the last errors of prediction, and forgets half of them each time."""
        off = self._centre(T_camera_target) - self._centre(expected.T_camera_target)
        error = float(np.linalg.norm(off))
        if np.isfinite(error):
            self._surprise_px = max(0.5 * self._surprise_px, error)

    def forget(self) -> None:
        """The target was lost."""
        self._last = self._before = None
        self._surprise_px = 0.0

    def predict(self, stamp_ns: int) -> Prediction | None:
        """t = t_2 + (t_2 - t_1) dt / (s_2 - s_1), R = R_2, docs/detect.md eq. (9). None if the last pose is old."""
        last, before = self._last, self._before
        if last is None:
            return None
        age_s = _NS * (stamp_ns - last.stamp_ns)
        if abs(age_s) > HOLD_S:
            return None
        T = last.T_camera_target.copy()
        if before is not None:
            step_s = _NS * (last.stamp_ns - before.stamp_ns)
            if 0.0 < step_s <= HOLD_S:
                T[:3, 3] += (T[:3, 3] - before.T_camera_target[:3, 3]) * (age_s / step_s)
        return Prediction(T_camera_target=T, covariance=last.covariance, age_s=abs(age_s))

    def region(self, prediction: Prediction) -> Region | None:
        """Box of the projected landmarks, cut at the image, padded, with a margin; None if the image has none of it.

        margin = 3 sigma of the middle + last errors of prediction + f a dt^2 / 2, docs/detect.md eq. (10).
        """
        square = projected_square(self._X, self._camera, prediction.T_camera_target)
        if square is None:
            return None
        middle, side = square
        focal = float(self._camera.K[0, 0])
        shake = 0.5 * SHAKE_RAD_S2 * prediction.age_s**2 * focal
        margin = 3.0 * self._middle_sigma_px(prediction) + self._surprise_px + shake
        padded = self._pad * side
        return Region(middle=middle, side=min(padded + 2.0 * margin, MAX_GROWTH * padded), margin_px=margin)

    def _centre(self, T_camera_target: Matrix4) -> np.ndarray:
        return project(self._camera, transform(T_camera_target, self._X.mean(axis=0)[None]))[0]

    def _middle_sigma_px(self, prediction: Prediction) -> float:
        """Largest standard deviation of the middle of the model in the image, by the pose's covariance [px]."""
        sigmas = np.sqrt(np.maximum(np.diag(prediction.covariance), 0.0))
        steps = np.where(sigmas > 0.0, 1e-3 * sigmas, 1e-9)
        at = self._centre(prediction.T_camera_target)
        T = prediction.T_camera_target
        J = np.column_stack(
            [(self._centre(T @ exp_se3(s * e)) - at) / s for s, e in zip(steps, np.eye(6), strict=True)]
        )
        S = J @ prediction.covariance @ J.T
        return float(np.sqrt(np.linalg.eigvalsh(S)[-1])) if np.isfinite(S).all() else 0.0


def projected_square(
    X_target: Points3, camera: Camera, T_camera_target: Matrix4
) -> tuple[tuple[float, float], float] | None:
    """Middle and side of the smallest square about the landmarks' box, the box being cut at the image [px]."""
    pixels = project(camera, transform(T_camera_target, X_target))
    pixels = pixels[np.isfinite(pixels).all(axis=1)]
    if len(pixels) == 0:
        return None
    edge = np.array([camera.width, camera.height]) - 0.5
    low, high = np.maximum(pixels.min(axis=0), -0.5), np.minimum(pixels.max(axis=0), edge)
    if not (low < edge).all() or not (high > -0.5).all() or not (low <= high).all():
        return None
    middle = 0.5 * (low + high)
    return (float(middle[0]), float(middle[1])), float((high - low).max())
