# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The part of an image that a network looks at, and the way back to the image's pixels, docs/detect.md section 2."""

from dataclasses import dataclass

import numpy as np

from fairlead.opencv import Image
from fairlead.opencv.crops import Crop, cut_resized
from fairlead.types import PixelCovariances, Pixels

MIN_SIDE_PX = 16
"""No window is smaller in the image: there is nothing to be seen in fewer pixels."""


@dataclass(frozen=True, kw_only=True)
class Window:
    """A rectangle of whole pixels of an image, and the size in which the network gets it."""

    corner: tuple[int, int]
    """Column and row of its top-left pixel."""
    extent: tuple[int, int]
    """Width and height in the image [px]."""
    size: tuple[int, int]
    """Width and height of the crop [px]."""

    def cut(self, image: Image) -> Crop:
        """The crop: area mean where it shrinks, bilinear where it grows."""
        return cut_resized(image, self.corner, self.extent, self.size)

    @property
    def scale(self) -> np.ndarray:
        """Pixels of the crop for one of the image, along u and v (2,)."""
        return np.array(self.size) / np.array(self.extent)

    def to_crop(self, pixels: Pixels) -> Pixels:
        """z' = (z - corner + 1/2) size / extent - 1/2, docs/detect.md eq. (1)."""
        return (pixels - np.array(self.corner) + 0.5) * self.scale - 0.5

    def to_image(self, pixels: Pixels) -> Pixels:
        """z = (z' + 1/2) extent / size + corner - 1/2: the inverse of `to_crop`."""
        return (pixels + 0.5) / self.scale + np.array(self.corner) - 0.5

    def covariances_to_image(self, covariances: PixelCovariances) -> PixelCovariances:
        """S = A S' A, A = diag(extent / size), docs/detect.md eq. (2)."""
        inverse = 1.0 / self.scale
        return covariances * np.outer(inverse, inverse)


def window_about(middle: np.ndarray, side: float, size: tuple[int, int]) -> Window:
    """The window of the size's shape about a point (2,) [px] that holds a square of `side` px; whole pixels."""
    width, height = size
    unit = max(float(side), MIN_SIDE_PX) / min(width, height)
    extent = (max(1, round(unit * width)), max(1, round(unit * height)))
    left, top = (round(float(m) + 0.5 - 0.5 * e) for m, e in zip(middle, extent, strict=True))
    return Window(corner=(left, top), extent=extent, size=size)
