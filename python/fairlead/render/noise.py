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


def sample_tile(tile: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Bilinear values of an (n, n, ...) tile, which repeats, at u, v in units of it, (...).

    The first value lies half a step from the tile's corner, as in a texture.
    """
    n = len(tile)
    x, y = np.asarray(u) * n - 0.5, np.asarray(v) * n - 0.5
    i, j = np.floor(x).astype(int) % n, np.floor(y).astype(int) % n
    fx, fy = (np.expand_dims(p - np.floor(p), tuple(range(p.ndim, p.ndim + tile.ndim - 2))) for p in (x, y))
    i1, j1 = (i + 1) % n, (j + 1) % n
    top = tile[j, i] * (1 - fx) + tile[j, i1] * fx
    return top * (1 - fy) + (tile[j1, i] * (1 - fx) + tile[j1, i1] * fx) * fy
