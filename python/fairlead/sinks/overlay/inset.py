# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Where the magnified view of the target is taken from and where it is put, without jumping about."""

from dataclasses import dataclass

import numpy as np

from fairlead.types import Pixels

SHARE = 0.46
"""Side of the inset over the shorter side of the image [-]."""
_MARGIN = 1.35
_MIN_ZOOM = 1.8
_COME_BACK = 1.15
"""An inset that went comes back at so much more than _MIN_ZOOM, so that it does not flicker."""
_FOLLOW = 0.2


@dataclass(frozen=True, kw_only=True, eq=False)
class Window:
    """A square of the image, shown magnified in a corner of it."""

    centre: Pixels
    """(1, 2) [px]."""
    shown_px: float
    """Side of the square that is shown."""
    left: int
    """Top-left pixel of the inset."""
    top: int
    side: int
    """Of the inset."""

    def square(self) -> Pixels:
        """Corners of what is shown, in the image."""
        half = 0.5 * self.shown_px
        return self.centre + half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


class Follower:
    """Follows the target smoothly; changes the corner, never to that of the caption, when the target comes under it."""

    def __init__(self, width: int, height: int) -> None:
        self._size = np.array([float(width), float(height)])
        self._side = round(SHARE * min(width, height))
        self._corner = np.array([1.0, 0.0])
        self._state: np.ndarray | None = None
        self._open = True

    def follow(self, low: np.ndarray, high: np.ndarray) -> Window | None:
        """The window for a target that reaches from low to high [px]; None where it is large already."""
        wanted = np.append(0.5 * (low + high), np.log(max(_MARGIN * float((high - low).max()), 24.0)))
        if self._state is None or np.abs(wanted[:2] - self._state[:2]).max() > 0.5 * np.exp(self._state[2]):
            self._state = wanted
        self._state = self._state + _FOLLOW * (wanted - self._state)
        shown = float(np.exp(self._state[2]))
        self._open = self._side >= _MIN_ZOOM * shown * (1.0 if self._open else _COME_BACK)
        if not self._open:
            return None
        self._choose(low, high)
        left, top = self._place(self._corner)
        return Window(centre=self._state[None, :2], shown_px=shown, left=left, top=top, side=self._side)

    def _place(self, corner: np.ndarray) -> tuple[int, int]:
        gap = round(0.02 * self._side)
        room = self._size - self._side - 2 * gap
        left, top = np.round(gap + corner * room).astype(int)
        return int(left), int(top)

    def _choose(self, low: np.ndarray, high: np.ndarray) -> None:
        def covered(corner: np.ndarray) -> float:
            place = np.array(self._place(corner), dtype=np.float64)
            overlap = np.minimum(high, place + self._side) - np.maximum(low, place)
            return float(np.prod(np.clip(overlap, 0.0, None)))

        if covered(self._corner) > 0.0:
            corners = [np.array(each, dtype=np.float64) for each in ((1, 0), (1, 1), (0, 1))]
            self._corner = min(corners, key=covered)
