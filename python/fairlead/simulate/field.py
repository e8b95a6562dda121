# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Errors that stay while the view stays: a random field over aspect, range and time. docs/simulate.md eq. (31)."""

import numpy as np
from jaxtyping import Float64

WAVES = 256
"""The correlation of a flight differs from the told one by about 1 / sqrt(2 x 256)."""
_IMAGES = 4096
"""At once, so that a long flight needs no more memory."""


def waves(dimensions: int, length: float, rng: np.random.Generator) -> Float64[np.ndarray, "w d"]:
    """Wave vectors of a field of correlation exp(-distance / length): multivariate Cauchy, one degree of freedom."""
    if length == 0.0:
        return np.zeros((WAVES, dimensions))
    return rng.standard_normal((WAVES, dimensions)) / (length * np.abs(rng.standard_normal((WAVES, 1))))


def stationary_field(
    places: Float64[np.ndarray, "k d"],
    vectors: Float64[np.ndarray, "w d"],
    shape: tuple[int, ...],
    rng: np.random.Generator,
) -> Float64[np.ndarray, "k ..."]:
    """Independent Gaussian fields of variance 1 at k places, one for each element of shape: sums of random waves."""
    amplitudes = rng.standard_normal((2, len(vectors), int(np.prod(shape)))) / np.sqrt(len(vectors))
    values = np.empty((len(places), amplitudes.shape[2]))
    for first in range(0, len(places), _IMAGES):
        phases = places[first : first + _IMAGES] @ vectors.T
        values[first : first + _IMAGES] = np.cos(phases) @ amplitudes[0] + np.sin(phases) @ amplitudes[1]
    return values.reshape(len(places), *shape)
