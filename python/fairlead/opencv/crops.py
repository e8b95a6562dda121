# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Rectangles of whole pixels cut out of an image and brought to another size."""

import numpy as np
from jaxtyping import UInt8

from fairlead.opencv.images import Image

Crop = UInt8[np.ndarray, "rows columns 3"]
"""Blue, green, red."""


def cut_resized(image: Image, corner: tuple[int, int], extent: tuple[int, int], size: tuple[int, int]) -> Crop:
    """The rectangle whose top-left pixel is `corner`, `extent` (width, height) px, in `size` (width, height) px.

    Pixel u of the image lies at (u - corner + 1/2) size / extent - 1/2. Smaller: area mean, every pixel has its share,
    so nothing is aliased; larger: bilinear. Where the image does not reach its edge goes on.
    """
    import cv2

    height, width = image.shape[:2]
    (left, top), (right, bottom) = corner, (corner[0] + extent[0], corner[1] + extent[1])
    # Far outside nothing but the edge is repeated; the part that is cut out first must hold a pixel of the image.
    x0, x1 = min(max(left, 0), width - 1), max(min(right, width), 1)
    y0, y1 = min(max(top, 0), height - 1), max(min(bottom, height), 1)
    x1, y1 = max(x1, x0 + 1), max(y1, y0 + 1)
    part = image[y0:y1, x0:x1]
    if (left, top, right, bottom) != (x0, y0, x1, y1):
        part = _grown(part, (left, top, right, bottom), (x0, y0, x1, y1))
    if size == extent:
        return np.ascontiguousarray(part)
    smaller = size[0] * size[1] < extent[0] * extent[1]
    return np.asarray(cv2.resize(part, size, interpolation=cv2.INTER_AREA if smaller else cv2.INTER_LINEAR))


def _grown(part: Image, wanted: tuple[int, int, int, int], had: tuple[int, int, int, int]) -> Crop:
    """The part with its edges repeated outwards, or moved to where the rectangle lies if that is off the image."""
    (left, top, right, bottom), (x0, y0, x1, y1) = wanted, had
    columns = np.clip(np.arange(left, right), x0, x1 - 1) - x0
    rows = np.clip(np.arange(top, bottom), y0, y1 - 1) - y0
    return np.ascontiguousarray(part[rows[:, None], columns[None, :]])
