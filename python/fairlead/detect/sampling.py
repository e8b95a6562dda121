# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Grey values between pixels, and where a profile of them crosses a level."""

import numpy as np


def bilinear(values: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Grey values (...) at points (..., 2) [px], pixel (0, 0) being a centre; NaN outside the image."""
    height, width = values.shape
    with np.errstate(invalid="ignore"):
        inside = (points >= 0.0).all(axis=-1) & (points[..., 0] <= width - 1) & (points[..., 1] <= height - 1)
    safe = np.where(inside[..., None], points, 0.0)
    column = np.minimum(safe[..., 0].astype(np.intp), max(width - 2, 0))
    row = np.minimum(safe[..., 1].astype(np.intp), max(height - 2, 0))
    right, below = np.minimum(column + 1, width - 1), np.minimum(row + 1, height - 1)
    a, b = safe[..., 0] - column, safe[..., 1] - row
    upper = (1.0 - a) * values[row, column] + a * values[row, right]
    lower = (1.0 - a) * values[below, column] + a * values[below, right]
    return np.where(inside, (1.0 - b) * upper + b * lower, np.nan)


def smooth(profiles: np.ndarray, s: np.ndarray, sigma: np.ndarray) -> np.ndarray:
    """Gaussian mean along the last axis of profiles (..., m, n), sampled at s (..., n), width sigma (...)."""
    apart = (s[..., :, None] - s[..., None, :]) / sigma[..., None, None]
    with np.errstate(all="ignore"):
        kernel = np.exp(-0.5 * apart**2)
        kernel /= kernel.sum(axis=-1, keepdims=True)
        return profiles @ kernel.swapaxes(-1, -2)


def level_crossing(profiles: np.ndarray, s: np.ndarray, level: np.ndarray) -> np.ndarray:
    """Where a profile rises through its level, nearest to s = 0; NaN where it does not.

    profiles (..., n) at s (..., n) with s rising, level (...). Linear between samples.
    """
    height = profiles - level[..., None]
    with np.errstate(all="ignore"):
        rises = (height[..., :-1] < 0.0) & (height[..., 1:] >= 0.0)
        share = -height[..., :-1] / (height[..., 1:] - height[..., :-1])
        crossing = s[..., :-1] + share * (s[..., 1:] - s[..., :-1])
    distance = np.where(rises, np.abs(crossing), np.inf)
    nearest = np.argmin(distance, axis=-1)[..., None]
    found = np.take_along_axis(crossing, nearest, axis=-1)[..., 0]
    return np.where(np.isfinite(np.take_along_axis(distance, nearest, axis=-1)[..., 0]), found, np.nan)
