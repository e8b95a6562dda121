# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A view as the baselines use it, and the estimate that they give when they have no pose."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Int64

from fairlead.tracker import LandmarkIndex
from fairlead.types import Camera, PixelCovariances, Pixels, View


@dataclass(frozen=True, kw_only=True, eq=False)
class Observed:
    """The usable observations of a view: finite, with a positive definite covariance, each landmark once."""

    index: Int64[np.ndarray, "n"]
    """Numbers of the landmarks in the target."""
    pixels: Pixels
    covariances: PixelCovariances


def observed(view: View, index: LandmarkIndex) -> Observed:
    """Drop what cannot be used; of a landmark seen twice the first is kept. ValueError for an unknown landmark."""
    numbers = index(view.landmarks).astype(np.int64)
    finite = np.isfinite(view.pixels).all(axis=1) & np.isfinite(view.covariances).all(axis=(1, 2))
    S = view.covariances
    with np.errstate(all="ignore"):
        definite = (S[:, 0, 0] > 0.0) & (S[:, 0, 0] * S[:, 1, 1] - S[:, 0, 1] * S[:, 1, 0] > 0.0)
    first = np.zeros(len(numbers), dtype=bool)
    usable = np.flatnonzero(finite & definite)
    first[usable[np.unique(numbers[usable], return_index=True)[1]]] = True
    return Observed(index=numbers[first], pixels=view.pixels[first], covariances=view.covariances[first])


def plain(camera: Camera) -> Camera:
    """The same camera without a lens model where all its coefficients are zero: that is much faster."""
    if camera.model == "equidistant" or camera.distortion.any():
        return camera
    return replace(camera, model="pinhole", distortion=np.empty(0))
