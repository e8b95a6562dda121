# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Drawing on images, to an eighth of a pixel: each function changes the image that it is given."""

import numpy as np
from jaxtyping import Float64, UInt8

from fairlead.opencv.images import GreyImage, Image
from fairlead.types import Pixels

Colour = tuple[int, int, int]
"""Blue, green, red."""
Triangles = Float64[np.ndarray, "n 3 2"]
"""Corners in the image [px]."""

Line = Float64[np.ndarray, "_ 2"]
"""Points along a line [px]."""

_SHIFT = 3
_FAR_PX = 2.0**15
"""Nothing further out is drawn: OpenCV counts eighths of a pixel in 32 bits."""


def fill_triangles(mask: GreyImage, triangles: Triangles) -> None:
    """Set the mask to 255 wherever one of the triangles is; those with corners that are not finite are left out."""
    import cv2

    near = (np.abs(triangles) < _FAR_PX).all(axis=(1, 2))
    for corners in _fixed(triangles[near]):
        cv2.fillConvexPoly(mask, corners, 255, cv2.LINE_8, _SHIFT)


def contours(mask: GreyImage) -> list[Line]:
    """The edges of all regions of the mask, holes too, as closed lines through the centres of their pixels."""
    import cv2

    found, _ = cv2.findContours(mask, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    return [np.asarray(line, dtype=np.float64).reshape(-1, 2) for line in found]


def draw_lines(image: Image, lines: list[Line], colour: Colour, *, width: int = 1, closed: bool = False) -> None:
    """Smooth lines through the points of each."""
    import cv2

    usable = [_fixed(line) for line in lines if len(line) and (np.abs(line) < _FAR_PX).all()]
    if usable:
        cv2.polylines(image, usable, closed, colour, width, cv2.LINE_AA, _SHIFT)


def fill_polygon(image: Image, corners: Pixels, colour: Colour) -> None:
    """A convex polygon with smooth edges."""
    import cv2

    if len(corners) and (np.abs(corners) < _FAR_PX).all():
        cv2.fillConvexPoly(image, _fixed(corners), colour, cv2.LINE_AA, _SHIFT)


def fill_region(mask: GreyImage, lines: list[Line]) -> None:
    """Set the mask to 255 between closed lines: what two of them enclose is a hole."""
    import cv2

    usable = [_fixed(line) for line in lines if len(line) and (np.abs(line) < _FAR_PX).all()]
    if usable:
        cv2.fillPoly(mask, usable, 255, cv2.LINE_AA, _SHIFT)


def resample(
    image: Image, size: tuple[int, int], scale: float, origin: tuple[float, float]
) -> UInt8[np.ndarray, "rows columns 3"]:
    """A new image of `size` (width, height) whose pixel q shows origin + q / scale; edges are continued."""
    import cv2

    T = np.array([[1.0 / scale, 0.0, origin[0]], [0.0, 1.0 / scale, origin[1]]])
    flags = cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP
    return np.asarray(cv2.warpAffine(image, T, size, flags=flags, borderMode=cv2.BORDER_REPLICATE))


def _fixed(points: np.ndarray) -> np.ndarray:
    return np.round(points * 2.0**_SHIFT).astype(np.int32)
