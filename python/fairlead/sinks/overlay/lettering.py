# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Text on images, in the typeface that matplotlib brings along."""

from functools import lru_cache
from typing import Any

import numpy as np
from jaxtyping import UInt8

from fairlead.opencv import Colour, Image

Stamp = UInt8[np.ndarray, "h w"]


@lru_cache(maxsize=256)
def text_mask(text: str, size_px: int, *, bold: bool = False) -> Stamp:
    """Coverage of one line of text, 0 to 255; every line of a size has the same height and baseline."""
    font, height, below = _font(size_px, bold)
    font.set_text(text or " ")
    font.draw_glyphs_to_bitmap(antialiased=True)
    drawn = np.array(font.get_image(), dtype=np.uint8)
    _, own_below = _extent(font)
    mask = np.zeros((height + 2, drawn.shape[1] + 1), np.uint8)
    bottom = min(len(mask), len(mask) - below + own_below)
    top = max(0, bottom - len(drawn))
    mask[top:bottom, : drawn.shape[1]] = drawn[len(drawn) - (bottom - top) :]
    return mask


@lru_cache(maxsize=16)
def _font(size_px: int, bold: bool) -> tuple[Any, int, int]:  # noqa: FBT001
    """A typeface, and height and depth of its lines [px]."""
    from matplotlib.font_manager import FontProperties, findfont
    from matplotlib.ft2font import FT2Font

    font = FT2Font(findfont(FontProperties(family="DejaVu Sans", weight="bold" if bold else "normal")))
    font.set_size(size_px, 72)
    font.set_text("Åg")
    return font, *_extent(font)


def _extent(font: Any) -> tuple[int, int]:
    """Height of the text that is set, and how far it hangs below the baseline [px]."""
    _, height = font.get_width_height()
    return round(height / 64), round(font.get_descent() / 64)


def write_text(
    image: Image, text: str, at: tuple[int, int], size_px: int, colour: Colour, *, bold: bool = False
) -> int:
    """Write on the image, `at` being the top-left corner; what leaves the image is cut. Returns the width [px]."""
    mask = text_mask(text, size_px, bold=bold)
    x, y = at
    part = image[max(y, 0) : y + mask.shape[0], max(x, 0) : x + mask.shape[1]]
    seen = mask[max(-y, 0) :, max(-x, 0) :][: part.shape[0], : part.shape[1], None].astype(np.float32) / 255.0
    part[:] = np.round((1.0 - seen) * part + seen * np.array(colour, np.float32)).astype(np.uint8)
    return int(mask.shape[1])
