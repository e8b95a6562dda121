# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""How two views of unknown points lie to one another, up to the length of the step between them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool

from fairlead.opencv.pnp import ideal_pixels
from fairlead.types import Camera, Matrix4, Pixels, is_rigid

MIN_POINTS = 6
"""Five determine a handful of answers; one more tells them apart."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TwoViews:
    """A relative pose that passed the checks."""

    T_b_a: Matrix4
    """p_b = T_b_a p_a; the translation has length 1."""
    inliers: Bool[np.ndarray, "n"]
    """Points that agree and lie in front of both."""


def relative_pose(pixels_a: Pixels, pixels_b: Pixels, camera: Camera, threshold_px: float = 2.0) -> TwoViews | None:
    """Five-point RANSAC and the one of four poses that has the points in front.

    Source: Nister 2004, An efficient solution to the five-point relative pose problem. None for fewer than MIN_POINTS
    points, numbers that are not finite, pixels beyond the lens, or an answer that fails a check.
    """
    import cv2

    if len(pixels_a) != len(pixels_b):
        raise ValueError(f"two views: expected as many points in both, got {len(pixels_a)} and {len(pixels_b)}")
    a, b = ideal_pixels(camera, pixels_a), ideal_pixels(camera, pixels_b)
    if len(a) < MIN_POINTS or not (np.isfinite(a).all() and np.isfinite(b).all()):
        return None
    K = camera.K.copy()
    try:
        E, mask = cv2.findEssentialMat(a, b, K, method=cv2.RANSAC, prob=0.9999, threshold=threshold_px)
        if np.shape(E) != (3, 3):
            return None
        _, R, t, mask = cv2.recoverPose(E, a, b, K, mask=mask)
    except cv2.error:
        return None
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, np.ravel(t)
    if not is_rigid(T):
        return None
    return TwoViews(T_b_a=T, inliers=np.asarray(np.ravel(mask) > 0, dtype=np.bool_))
