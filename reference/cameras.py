# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Projection of four camera models and its derivative by central differences, docs/bound.md eq. (2).

Source: OpenCV calib3d manual (plumb_bob, rational_polynomial); Kannala and Brandt 2006, eq. (6) (equidistant).
"""

from collections.abc import Callable

import numpy as np

Project = Callable[[np.ndarray], np.ndarray]
"""(..., 3) points in the camera frame -> (..., 2) [px]; NaN where the depth is not positive."""


def _radial_tangential(xy: np.ndarray, k: np.ndarray) -> np.ndarray:
    k1, k2, p1, p2, k3, k4, k5, k6 = k
    x, y = xy[..., 0], xy[..., 1]
    r2 = x * x + y * y
    radial = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1 + r2 * (k4 + r2 * (k5 + r2 * k6)))
    return np.stack(
        [x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y],
        axis=-1,
    )


def _equidistant(xy: np.ndarray, k: np.ndarray) -> np.ndarray:
    r = np.linalg.norm(xy, axis=-1)
    theta = np.arctan(r)
    bent = theta * (1 + theta**2 * (k[0] + theta**2 * (k[1] + theta**2 * (k[2] + theta**2 * k[3]))))
    return xy * np.where(r > 1e-12, bent / np.maximum(r, 1e-300), 1.0)[..., None]


def make_projection(model: str, K: np.ndarray, distortion: np.ndarray) -> Project:
    """The function p_camera -> z [px] of a camera; pixel (0, 0) is the centre of the top-left pixel.

    Parameters
    ----------
    model : pinhole, plumb_bob (k1 k2 p1 p2 k3), rational_polynomial (k1 k2 p1 p2 k3 k4 k5 k6) or equidistant (k1..k4)
    K : (3, 3) [px]
    distortion : the coefficients in that order
    """
    if model not in ("pinhole", "plumb_bob", "rational_polynomial", "equidistant"):
        raise ValueError(f"unknown camera model {model!r}")
    k = np.zeros(8)
    k[: len(distortion)] = distortion
    focal, centre = np.array([K[0, 0], K[1, 1]]), np.array([K[0, 2], K[1, 2]])

    def project(p_camera: np.ndarray) -> np.ndarray:
        depth = p_camera[..., 2:3]
        xy = p_camera[..., :2] / np.where(depth > 0, depth, np.nan)
        if model == "equidistant":
            xy = _equidistant(xy, k)
        elif model != "pinhole":
            xy = _radial_tangential(xy, k)
        return focal * xy + centre

    return project


def projection_jacobian(project: Project, p_camera: np.ndarray) -> np.ndarray:
    """d project / d p_camera, (..., 2, 3) [px/m], by central differences with a step of 1e-5 of the depth.

    Truncation is (1e-5)^2 and rounding about 1e-11 relative, so nine digits are good.
    """
    step = 1e-5 * np.abs(p_camera[..., 2])
    columns = []
    for axis in range(3):
        h = np.zeros_like(p_camera)
        h[..., axis] = step
        columns.append((project(p_camera + h) - project(p_camera - h)) / (2 * step[..., None]))
    return np.stack(columns, axis=-1)
