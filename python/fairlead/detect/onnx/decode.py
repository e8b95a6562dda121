# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Outputs of a network to keypoints of the crop, docs/detect.md section 3 and 4."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from fairlead.detect.keypoints import Keypoints
from fairlead.io.network_card import NetworkCard

_LOG_LIMIT = 12.0
"""Logarithms of sigmas are cut at +-12: a pixel's thousandth of a thousandth is as good as none."""
_TINY = 1e-10
_WINDOW_CELLS = 3
"""Of a heatmap's peak whose spread is measured, to either side."""


def decode(card: NetworkCard, outputs: Sequence[np.ndarray]) -> Keypoints:
    """Keypoints in pixels of the crop; outputs without the batch's dimension, in the order of the card."""
    arrays = [np.asarray(output, dtype=np.float64) for output in outputs]
    if card.decoding.kind == "pixels":
        return _pixels(card, *arrays)
    if card.decoding.kind == "simcc":
        return _simcc(card, *arrays)
    return _heatmap(card, arrays[0])


def _pixels(card: NetworkCard, pixels: np.ndarray, cholesky: np.ndarray, visible: np.ndarray) -> Keypoints:
    """S = scale L L^T + floor^2 I, docs/detect.md eq. (3)."""
    with np.errstate(invalid="ignore"):
        l11, l22 = np.exp(np.clip(cholesky[:, :2], -_LOG_LIMIT, _LOG_LIMIT)).T
    l21 = cholesky[:, 2]
    S = np.empty((len(pixels), 2, 2))
    S[:, 0, 0], S[:, 1, 1] = l11 * l11, l21 * l21 + l22 * l22
    S[:, 0, 1] = S[:, 1, 0] = l11 * l21
    scaled = card.per_landmark(card.calibration.scale)[:, None, None] * S
    floor = card.calibration.floor_px**2 * np.eye(2)
    return Keypoints(pixels=pixels, covariances=scaled + floor, scores=visible)


def _simcc(card: NetworkCard, x: np.ndarray, y: np.ndarray) -> Keypoints:
    """A windowed expectation along each axis, docs/detect.md eq. (4)."""
    u, spread_u = _expectation(card, x)
    v, spread_v = _expectation(card, y)
    spread = np.zeros((len(u), 2, 2))
    spread[:, 0, 0], spread[:, 1, 1] = spread_u, spread_v
    scores = np.minimum(x.max(axis=1), y.max(axis=1))
    return Keypoints(pixels=np.column_stack([u, v]), covariances=_told(card, spread), scores=scores)


def _expectation(card: NetworkCard, values: Float64[np.ndarray, "n bins"]) -> tuple[np.ndarray, np.ndarray]:
    """Mean [px] and variance [px^2] of the weights about the highest bin."""
    decoding = card.decoding
    bins = np.arange(values.shape[1])
    with np.errstate(invalid="ignore", over="ignore"):
        highest = values.max(axis=1, keepdims=True)
        raised = np.exp(decoding.beta * (values - highest)) if decoding.beta > 0.0 else np.maximum(values, 0.0)
        near = np.abs(bins - np.argmax(values, axis=1)[:, None]) <= decoding.window
        weights = np.where(near, raised, 0.0)
        weights /= weights.sum(axis=1, keepdims=True)
        mean = weights @ bins
        variance = (weights * (bins - mean[:, None]) ** 2).sum(axis=1)
    return mean / decoding.bins_per_px + decoding.origin_px, variance / decoding.bins_per_px**2


def _heatmap(card: NetworkCard, maps: Float64[np.ndarray, "n h w"]) -> Keypoints:
    """DARK: one Newton step on the logarithm of the smoothed map from its highest cell, docs/detect.md eq. (5)."""
    decoding = card.decoding
    n, height, width = maps.shape
    scores = maps.reshape(n, -1).max(axis=1)
    rows, columns = np.divmod(np.argmax(maps.reshape(n, -1), axis=1), width)
    patches = _log_patches(maps, rows, columns, decoding.blur)
    cells = np.column_stack([columns, rows]) + _newton_step(patches)
    pixels = cells * decoding.stride + decoding.origin_px
    inside = (columns > 0) & (columns < width - 1) & (rows > 0) & (rows < height - 1)
    pixels = np.where(inside[:, None], pixels, np.column_stack([columns, rows]) * decoding.stride + decoding.origin_px)
    spread = decoding.stride**2 * _peak_covariances(maps, rows, columns)
    return Keypoints(pixels=pixels, covariances=_told(card, spread), scores=scores)


def _log_patches(maps: np.ndarray, rows: np.ndarray, columns: np.ndarray, sigma: float) -> np.ndarray:
    """(n, 5, 5) logarithms about the highest cells of the maps after a Gaussian of `sigma` cells."""
    reach = int(np.ceil(2.5 * sigma))
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / max(sigma, _TINY)) ** 2)
    kernel /= kernel.sum()
    smoothing = np.array([np.convolve(kernel, row) for row in np.eye(5)])  # (5, 5 + 2 reach)
    around = _around(maps, rows, columns, 2 + reach, 0.0)
    return np.log(np.maximum(np.einsum("ai,nij,bj->nab", smoothing, around, smoothing), _TINY))


def _around(maps: np.ndarray, rows: np.ndarray, columns: np.ndarray, reach: int, beyond: float) -> np.ndarray:
    """(n, 2 reach + 1, 2 reach + 1) cells about one of each map; `beyond` where the map ends."""
    n, height, width = maps.shape
    offsets = np.arange(-reach, reach + 1)
    r, c = rows[:, None, None] + offsets[:, None], columns[:, None, None] + offsets
    inside = (r >= 0) & (r < height) & (c >= 0) & (c < width)
    values = maps[np.arange(n)[:, None, None], np.clip(r, 0, height - 1), np.clip(c, 0, width - 1)]
    return np.where(inside, values, beyond)


def _newton_step(P: Float64[np.ndarray, "n 5 5"]) -> np.ndarray:
    """-H^-1 g at the middle, (n, 2) along u and v, at most a cell and a half; 0 where H is not negative definite."""
    gu, gv = 0.5 * (P[:, 2, 3] - P[:, 2, 1]), 0.5 * (P[:, 3, 2] - P[:, 1, 2])
    huu = 0.25 * (P[:, 2, 4] - 2.0 * P[:, 2, 2] + P[:, 2, 0])
    hvv = 0.25 * (P[:, 4, 2] - 2.0 * P[:, 2, 2] + P[:, 0, 2])
    huv = 0.25 * (P[:, 3, 3] - P[:, 1, 3] - P[:, 3, 1] + P[:, 1, 1])
    determinant = huu * hvv - huv * huv
    peak = (huu < 0.0) & (determinant > 0.0)
    safe = np.where(peak, determinant, 1.0)
    step = -np.column_stack([hvv * gu - huv * gv, huu * gv - huv * gu]) / safe[:, None]
    return np.where(peak[:, None], np.clip(step, -1.5, 1.5), 0.0)


def _peak_covariances(maps: np.ndarray, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Second moments of each peak in a window of cells (n, 2, 2) [cells^2]."""
    weights = np.maximum(_around(maps, rows, columns, _WINDOW_CELLS, 0.0), 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        weights /= weights.sum(axis=(1, 2), keepdims=True)
    offsets = np.arange(-_WINDOW_CELLS, _WINDOW_CELLS + 1, dtype=np.float64)
    columns_m, rows_m = weights.sum(axis=1), weights.sum(axis=2)
    mu, mv = columns_m @ offsets, rows_m @ offsets
    S = np.empty((len(maps), 2, 2))
    S[:, 0, 0], S[:, 1, 1] = columns_m @ offsets**2 - mu**2, rows_m @ offsets**2 - mv**2
    S[:, 0, 1] = S[:, 1, 0] = np.einsum("nij,i,j->n", weights, offsets, offsets) - mu * mv
    return S


def _told(card: NetworkCard, spread: Float64[np.ndarray, "n 2 2"]) -> np.ndarray:
    """S = sigma^2 I + factor spread, docs/detect.md eq. (6): the network itself says nothing of its errors."""
    sigma = card.per_landmark(card.calibration.sigma_px)
    S = sigma[:, None, None] ** 2 * np.eye(2)
    return S + card.calibration.spread_factor * spread if card.calibration.spread_factor > 0.0 else S
