# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Fractal noise that tiles: clouds, foam, weathered paint."""

import numpy as np
from jaxtyping import Float32

Tile = Float32[np.ndarray, "n n"]


def fractal_tile(size: int, slope: float, rng: np.random.Generator) -> Tile:
    """Gaussian noise whose power falls with frequency as f^-slope, mean 0.5, standard deviation 0.2, periodic."""
    k = np.fft.fftfreq(size) * size
    f = np.hypot(*np.meshgrid(k, k))
    f[0, 0] = 1.0
    spectrum = np.fft.fft2(rng.standard_normal((size, size))) * f ** (-0.5 * slope) * (f > 1.5)
    field = np.fft.ifft2(spectrum).real
    return np.clip(0.5 + 0.2 * (field - field.mean()) / field.std(), 0.0, 1.0).astype(np.float32)


def sample_tile(tile: Tile, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Bilinear values at u, v in units of the tile, which repeats."""
    n = len(tile)
    x, y = (np.asarray(u) % 1.0) * n, (np.asarray(v) % 1.0) * n
    i, j = np.floor(x).astype(int) % n, np.floor(y).astype(int) % n
    fx, fy = x - np.floor(x), y - np.floor(y)
    i1, j1 = (i + 1) % n, (j + 1) % n
    top = tile[j, i] * (1 - fx) + tile[j, i1] * fx
    return top * (1 - fy) + (tile[j1, i] * (1 - fx) + tile[j1, i1] * fx) * fy
