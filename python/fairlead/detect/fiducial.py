# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""ArUco and AprilTag bundles, ChArUco boards and chessboards, docs/fiducials.md."""

import re
from dataclasses import dataclass

import numpy as np

from fairlead import opencv
from fairlead.detect.edges import measure_tags
from fairlead.detect.saddles import measure_saddles
from fairlead.types import Correlation, Estimate, Target, View

CORNERS = ("tl", "tr", "br", "bl")
"""Corners of a tag in OpenCV's order, clockwise as the upright tag is seen."""
_TAG_LANDMARK = re.compile(r"tag([0-9]+)_(tl|tr|br|bl)")
_BOARD_LANDMARK = re.compile(r"corner([0-9]+)")


class TagDetector:
    """Tags of one family; tag 7 has the landmarks tag7_tl, tag7_tr, tag7_br, tag7_bl.

    A tag that is seen twice in an image is not reported: one of the two is not the target's.
    Raises ValueError for an unknown family, or a target without such landmarks.
    """

    correlation = Correlation()
    """Corners are measured anew in every image."""

    def __init__(self, family: str, target: Target | None = None) -> None:
        self._family = family
        self._cells = opencv.marker_cells(family)
        self._wanted = _wanted(target, _TAG_LANDMARK, "tag<id>_tl|tr|br|bl")

    def detect(self, image: opencv.Image | opencv.GreyImage, frame: int, stamp_ns: int) -> View:
        """The corners of all tags that could be measured. Raises ValueError for an image of another kind."""
        grey = opencv.grey(image)
        found = opencv.marker_corners(grey, self._family)
        ids, counts = np.unique(found.ids, return_counts=True)
        once = np.isin(found.ids, ids[counts == 1]) & np.array([self._is_wanted(int(i)) for i in found.ids], dtype=bool)
        patterns = np.array([self._pattern(int(i)) for i in found.ids[once]], dtype=bool)
        patterns = patterns.reshape(-1, self._cells, self._cells)
        measured = measure_tags(grey, found.corners[once], patterns)
        names = [f"tag{i}_{corner}" for i in found.ids[once][measured.measured] for corner in CORNERS]
        return _view(
            frame,
            stamp_ns,
            names,
            measured.corners[measured.measured].reshape(-1, 2),
            measured.covariances[measured.measured].reshape(-1, 2, 2),
            self._wanted,
        )

    def follow(self, estimate: Estimate) -> None:
        """Every image is searched as a whole."""

    def _is_wanted(self, identity: int) -> bool:
        return self._wanted is None or any(f"tag{identity}_{corner}" in self._wanted for corner in CORNERS)

    def _pattern(self, identity: int) -> np.ndarray:
        return opencv.marker_image(self._family, identity, 1) > 0


@dataclass(frozen=True)
class CharucoBoard:
    """A chessboard with tags in its white squares."""

    columns: int
    """Squares, not corners."""
    rows: int
    family: str
    marker_ratio: float
    """Tag side / square side [-]."""

    def __post_init__(self) -> None:
        self.find(np.full((64, 64), 255, np.uint8))

    def find(self, grey: opencv.GreyImage) -> opencv.FoundCorners:
        """Corners by their number in OpenCV's board; a board seen in part will do."""
        return opencv.charuco_corners(grey, self.columns, self.rows, self.family, self.marker_ratio)


@dataclass(frozen=True)
class Chessboard:
    """A plain chessboard; columns x rows inner corners, all of which must be seen."""

    columns: int
    rows: int

    def find(self, grey: opencv.GreyImage) -> opencv.FoundCorners:
        """Corners row by row from the one next to the first black square, clockwise round.

        Where columns + rows is even, a board turned by half looks the same, and may be found either way.
        """
        found = opencv.chessboard_corners(grey, self.columns, self.rows)
        if len(found.ids) == 0:
            return found
        grid = found.corners.reshape(self.rows, self.columns, 2)
        return opencv.FoundCorners(ids=found.ids, corners=_oriented(grey, grid).reshape(-1, 1, 2))


class BoardDetector:
    """Inner corners of a board, named corner0, corner1, ... as the board numbers them.

    Raises ValueError for a target without such landmarks.
    """

    correlation = Correlation()
    """Corners are measured anew in every image."""

    def __init__(self, board: CharucoBoard | Chessboard, target: Target | None = None) -> None:
        self._board = board
        self._wanted = _wanted(target, _BOARD_LANDMARK, "corner<number>")

    def detect(self, image: opencv.Image | opencv.GreyImage, frame: int, stamp_ns: int) -> View:
        """The corners that could be measured. Raises ValueError for an image of another kind."""
        grey = opencv.grey(image)
        found = self._board.find(grey)
        saddles = measure_saddles(grey, found.corners[:, 0])
        names = [f"corner{i}" for i in found.ids[saddles.measured]]
        pixels, covariances = saddles.corners[saddles.measured], saddles.covariances[saddles.measured]
        return _view(frame, stamp_ns, names, pixels, covariances, self._wanted)

    def follow(self, estimate: Estimate) -> None:
        """Every image is searched as a whole."""


def _oriented(grey: opencv.GreyImage, grid: np.ndarray) -> np.ndarray:
    """The grid clockwise as seen, and turned by half where its first inner square is white."""
    right, down = grid[0, -1] - grid[0, 0], grid[-1, 0] - grid[0, 0]
    if right[0] * down[1] - right[1] * down[0] < 0.0:
        grid = grid[:, ::-1]
    height, width = grey.shape
    squares = np.rint(0.25 * (grid[:-1, :-1] + grid[1:, :-1] + grid[:-1, 1:] + grid[1:, 1:])).astype(int)
    values = grey[np.clip(squares[..., 1], 0, height - 1), np.clip(squares[..., 0], 0, width - 1)].astype(np.float64)
    first = np.add.outer(np.arange(values.shape[0]), np.arange(values.shape[1])) % 2 == 0
    even, odd = float(np.median(values[first])), float(np.median(values[~first])) if (~first).any() else np.inf
    return grid[::-1, ::-1] if even > odd else grid


def _wanted(target: Target | None, pattern: re.Pattern[str], form: str) -> frozenset[str] | None:
    if target is None:
        return None
    wanted = frozenset(name for name in target.landmarks if pattern.fullmatch(name))
    if not wanted:
        names = ", ".join(target.landmarks[:4])
        raise ValueError(f"detector: expected a target with landmarks named {form}, got {names} ...")
    return wanted


def _view(
    frame: int,
    stamp_ns: int,
    names: list[str],
    pixels: np.ndarray,
    covariances: np.ndarray,
    wanted: frozenset[str] | None,
) -> View:
    kept = [i for i, name in enumerate(names) if wanted is None or name in wanted]
    return View(
        frame=frame,
        stamp_ns=stamp_ns,
        landmarks=tuple(names[i] for i in kept),
        pixels=pixels[kept].reshape(-1, 2),
        covariances=covariances[kept].reshape(-1, 2, 2),
    )
