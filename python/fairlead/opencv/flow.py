# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Points carried from one image to the next by optical flow, each checked on the way back."""

import numpy as np
from jaxtyping import Bool, UInt8

from fairlead.opencv.images import GreyImage
from fairlead.types import Pixels

WINDOW_PX = 21
LEVELS = 3
RETURN_PX = 1.0
"""A point that does not come back to within this of where it started was lost [px]."""


def carry_points(
    before: GreyImage, after: UInt8[np.ndarray, "rows columns"], pixels: Pixels, guesses: Pixels
) -> tuple[Pixels, Bool[np.ndarray, "n"]]:
    """Pyramidal Lucas-Kanade there and back. Source: Bouguet 2000, Pyramidal implementation of the LK feature tracker.

    Parameters
    ----------
    before, after : images of one size
    pixels : (n, 2) in `before` [px]
    guesses : (n, 2) where they are thought to be in `after` [px]

    Returns
    -------
    Where they are in `after` [px], and whether each was followed: found, inside, and back within RETURN_PX.
    """
    import cv2

    if before.shape != after.shape:
        raise ValueError(f"optical flow: expected images of one size, got {before.shape} and {after.shape}")
    if len(pixels) == 0:
        return pixels.copy(), np.zeros(0, dtype=np.bool_)
    size, flags = (WINDOW_PX, WINDOW_PX), cv2.OPTFLOW_USE_INITIAL_FLOW
    start = pixels.astype(np.float32).reshape(-1, 1, 2)
    guess = guesses.astype(np.float32).reshape(-1, 1, 2)
    there, found, _ = cv2.calcOpticalFlowPyrLK(
        before, after, start, guess.copy(), winSize=size, maxLevel=LEVELS, flags=flags
    )
    back, returned, _ = cv2.calcOpticalFlowPyrLK(
        after, before, there, start.copy() + there - guess, winSize=size, maxLevel=LEVELS, flags=flags
    )
    carried = there.reshape(-1, 2).astype(np.float64)
    gone = np.linalg.norm(back.reshape(-1, 2) - start.reshape(-1, 2), axis=1)
    height, width = before.shape
    inside = ((carried >= 0.0) & (carried <= np.array([width, height]) - 1.0)).all(axis=1)
    followed = (found.ravel() == 1) & (returned.ravel() == 1) & (gone <= RETURN_PX) & inside
    return carried, np.asarray(followed, dtype=np.bool_)
