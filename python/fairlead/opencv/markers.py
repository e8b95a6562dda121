# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Finding tags and boards. What comes back are first guesses to about a pixel; `fairlead.detect` measures them."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from jaxtyping import Float64, Int64

from fairlead.opencv.images import GreyImage

Dictionary = str
"""Name of a tag family as OpenCV spells it: DICT_4X4_100, DICT_APRILTAG_36h11, ..."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FoundCorners:
    """Corners of tags (one row per tag) or of a board (one row per corner)."""

    ids: Int64[np.ndarray, "n"]
    corners: Float64[np.ndarray, "n c 2"]
    """[px]; of a tag the four outer corners, clockwise from the one that is top left when the tag is upright."""


def marker_corners(image: GreyImage, family: Dictionary) -> FoundCorners:
    """Tags of a family. The corners are where OpenCV's quadrilateral has them, unrefined.

    Raises ValueError for an unknown family.
    """
    import cv2

    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_NONE
    detector = cv2.aruco.ArucoDetector(_dictionary(family), parameters)
    corners, ids, _ = detector.detectMarkers(image)
    return _found(ids, corners, 4)


def charuco_corners(image: GreyImage, columns: int, rows: int, family: Dictionary, marker_ratio: float) -> FoundCorners:
    """Inner corners of a ChArUco board of columns x rows squares; `marker_ratio` is tag side / square side [-].

    Raises ValueError for an unknown family, or a board that cannot be.
    """
    import cv2

    dictionary = _dictionary(family)
    if columns * rows // 2 > len(dictionary.bytesList):
        raise ValueError(f"charuco: expected at most {len(dictionary.bytesList)} tags, got {columns}x{rows} squares")
    try:
        board = cv2.aruco.CharucoBoard((columns, rows), 1.0, marker_ratio, dictionary)
        detector = cv2.aruco.CharucoDetector(board)
    except cv2.error as error:
        raise ValueError(f"charuco: expected a possible board, got {columns}x{rows} {family} {marker_ratio}") from error
    try:
        corners, ids, *_ = detector.detectBoard(image)
    except cv2.error:
        return _found(None, (), 1)
    return _found(ids, corners, 1)


def chessboard_corners(image: GreyImage, columns: int, rows: int) -> FoundCorners:
    """All inner corners (columns x rows of them) of a chessboard, row by row, or none.

    A board that looks the same turned by half is found either way round.
    """
    import cv2

    found, corners = cv2.findChessboardCornersSB(image, (columns, rows), None, cv2.CALIB_CB_NORMALIZE_IMAGE)
    if not found:
        return _found(None, (), 1)
    return _found(np.arange(columns * rows), corners, 1)


def marker_cells(family: Dictionary) -> int:
    """Cells along a tag's side, its black border of one cell included. Raises ValueError for an unknown family."""
    return int(_dictionary(family).markerSize) + 2


def marker_image(family: Dictionary, identity: int, cell_px: int) -> GreyImage:
    """The tag as it is printed, `cell_px` pixels a cell, black border but no quiet zone.

    Raises ValueError for an unknown family or identity.
    """
    import cv2

    try:
        image = cv2.aruco.generateImageMarker(_dictionary(family), identity, cell_px * marker_cells(family))
    except cv2.error as error:
        raise ValueError(f"tag {family}: got the unknown identity {identity}") from error
    return np.asarray(image)


def _dictionary(family: Dictionary) -> Any:
    import cv2

    known = [name for name in dir(cv2.aruco) if name.startswith("DICT_")]
    if family not in known:
        raise ValueError(f"tag family: expected one of {', '.join(known)}, got {family!r}")
    return cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, family))


def _found(ids: np.ndarray | None, corners: Any, each: Literal[1, 4]) -> FoundCorners:
    if ids is None or len(ids) == 0:
        return FoundCorners(ids=np.empty(0, np.int64), corners=np.empty((0, each, 2)))
    found = np.asarray(corners, dtype=np.float64).reshape(-1, each, 2)
    return FoundCorners(ids=np.ravel(ids).astype(np.int64), corners=found)
