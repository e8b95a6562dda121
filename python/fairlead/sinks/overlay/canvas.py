# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""An image that is drawn on in the coordinates of the camera's pixels, whatever its own resolution."""

import numpy as np

from fairlead import opencv
from fairlead.opencv import Colour, Image, Line
from fairlead.types import Pixels

_CIRCLE = np.column_stack([np.cos(a := np.linspace(0.0, 2.0 * np.pi, 49)[:-1]), np.sin(a)])


class Canvas:
    """Pixel q of the canvas shows pixel z = origin + q / scale of the camera."""

    def __init__(self, image: Image, *, scale: float = 1.0, origin: Pixels | None = None) -> None:
        self.image = image
        self.scale = scale
        self._origin = np.zeros((1, 2)) if origin is None else origin
        self.line = max(1, round(min(image.shape[:2]) / 700))
        """Width of a thin line [px of the canvas]."""

    @classmethod
    def magnified(cls, image: Image, side: int, centre: Pixels, shown_px: float) -> "Canvas":
        """A square of `side` pixels that shows `shown_px` pixels of the image about a point (1, 2)."""
        scale = side / shown_px
        origin = centre - 0.5 * (side - 1) / scale
        part = opencv.resample(image, (side, side), scale, (float(origin[0, 0]), float(origin[0, 1])))
        return cls(part, scale=scale, origin=origin)

    def place(self, pixels: Pixels) -> Pixels:
        """Where pixels of the camera are on the canvas."""
        return (pixels - self._origin) * self.scale

    def tint(self, edges: list[Line], colour: Colour, opacity: float) -> None:
        """Lay a colour over what closed lines enclose."""
        mask = np.zeros(self.image.shape[:2], np.uint8)
        opencv.fill_region(mask, [self.place(edge) for edge in edges])
        rows, columns = (np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0))
        if len(rows):
            box = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
            weight = (opacity / 255.0) * mask[box][..., None].astype(np.float32)
            mixed = (1.0 - weight) * self.image[box] + weight * np.array(colour, np.float32)
            self.image[box] = np.round(mixed).astype(np.uint8)

    def outline(self, edges: list[Line], colour: Colour, *, width: int) -> None:
        """Closed lines."""
        opencv.draw_lines(self.image, [self.place(edge) for edge in edges], colour, width=width, closed=True)

    def ellipse(self, centre: Pixels, covariance: np.ndarray, sigmas: float, colour: Colour, *, width: int) -> None:
        """{ z : (z - centre)^T S^-1 (z - centre) = sigmas^2 } of a covariance S [px^2] about a point (1, 2)."""
        if np.isfinite(covariance).all() and np.isfinite(centre).all():
            values, axes = np.linalg.eigh(covariance)
            half = sigmas * np.sqrt(np.clip(values, 0.0, None))
            line = self.place(centre + (_CIRCLE * half) @ axes.T)
            opencv.draw_lines(self.image, [line], colour, width=width, closed=True)

    def dot(self, centre: Pixels, radius: float, colour: Colour) -> None:
        """A disc; the radius is in pixels of the canvas."""
        if np.isfinite(centre).all():
            opencv.fill_polygon(self.image, self.place(centre) + radius * _CIRCLE, colour)

    def cross(self, centre: Pixels, arm: float, colour: Colour, *, width: int, turned: bool = False) -> None:
        """Two strokes, upright or turned by 45 degrees; the arm is in pixels of the canvas."""
        if not np.isfinite(centre).all():
            return
        step = np.array([[1.0, 1.0], [1.0, -1.0]]) / np.sqrt(2.0) if turned else np.eye(2)
        at = self.place(centre)
        strokes = [np.vstack([at - arm * direction, at + arm * direction]) for direction in step]
        opencv.draw_lines(self.image, strokes, colour, width=width)
