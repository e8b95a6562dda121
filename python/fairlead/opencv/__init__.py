# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""OpenCV behind one door: the only package that imports cv2, and only when something of it is called.

Works with OpenCV 4 and 5. Every pose that comes back was checked (docs/baselines.md section 1), every image was
measured by its header before it was decoded. `cv2.FileStorage` is not used: it corrupts the heap on malformed files.
"""

from fairlead.opencv.capture import open_capture
from fairlead.opencv.drawing import (
    Colour,
    Line,
    contours,
    draw_lines,
    fill_polygon,
    fill_region,
    fill_triangles,
    resample,
)
from fairlead.opencv.filters import warp_affine
from fairlead.opencv.flow import carry_points
from fairlead.opencv.images import GreyImage, Image, coloured, decode_image, grey, image_size, read_image
from fairlead.opencv.markers import (
    FoundCorners,
    charuco_corners,
    chessboard_corners,
    marker_cells,
    marker_corners,
    marker_image,
)
from fairlead.opencv.pnp import MIN_POINTS, PnpSolution, epnp, ideal_pixels, ippe, refine, sqpnp
from fairlead.opencv.pnp_views import epnp_views
from fairlead.opencv.two_views import TwoViews, relative_pose

__all__ = [
    "MIN_POINTS",
    "Colour",
    "FoundCorners",
    "GreyImage",
    "Image",
    "Line",
    "PnpSolution",
    "TwoViews",
    "carry_points",
    "charuco_corners",
    "chessboard_corners",
    "coloured",
    "contours",
    "decode_image",
    "draw_lines",
    "epnp",
    "epnp_views",
    "fill_polygon",
    "fill_region",
    "fill_triangles",
    "grey",
    "ideal_pixels",
    "image_size",
    "ippe",
    "marker_cells",
    "marker_corners",
    "marker_image",
    "open_capture",
    "read_image",
    "refine",
    "relative_pose",
    "resample",
    "sqpnp",
    "warp_affine",
]
