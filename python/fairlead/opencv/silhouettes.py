# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The outline of a projected mesh, filled."""

import numpy as np
from jaxtyping import Bool, Float64

_SHIFT = 4
_FAR = 30_000.0


def filled_triangles(triangles_px: Float64[np.ndarray, "m 3 2"], width: int, height: int) -> Bool[np.ndarray, "h w"]:
    """Pixels that any of the triangles covers, corners to 1/16 px; those that are not finite are left out."""
    import cv2

    usable = triangles_px[(np.abs(triangles_px) < _FAR).all(axis=(1, 2))]
    mask = np.zeros((height, width), np.uint8)
    for triangle in np.round(usable * 2**_SHIFT).astype(np.int32):
        cv2.fillConvexPoly(mask, triangle, 255, cv2.LINE_8, _SHIFT)
    return mask > 0
