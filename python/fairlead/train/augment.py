# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What a crop goes through before the network sees it, beside what the renderer varied. docs/networks.md section 4.

The renderer has drawn view, light, weather, things in the way, blur and noise; here a crop is turned, scaled, shifted
and cut, and its colours change, anew in every epoch.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64, UInt8

from fairlead.opencv import Image, warp_affine

Crop = UInt8[np.ndarray, "rows columns 3"]
HIDDEN, OUTSIDE = 1, 0


@dataclass(frozen=True, kw_only=True)
class Augmentation:
    """Spreads of what is drawn; all zero leaves the crop as it is."""

    rotation_deg: float = 20.0
    scale: float = 0.25
    """Log of the factor, one standard deviation."""
    shift: float = 0.06
    """Share of the side."""
    patches: float = 0.3
    """Share of the crops that lose a patch."""
    colour: float = 0.12
    noise: float = 4.0
    """Grey levels, at most."""


NONE = Augmentation(rotation_deg=0.0, scale=0.0, shift=0.0, patches=0.0, colour=0.0, noise=0.0)


def augment(
    image: Image,
    pixels: Float64[np.ndarray, "n 2"],
    visibility: Int64[np.ndarray, "n"],
    *,
    size: int,
    spread: Augmentation,
    rng: np.random.Generator,
) -> tuple[Crop, Float64[np.ndarray, "n 2"], Int64[np.ndarray, "n"]]:
    """A crop of size x size px and its labels; a landmark that leaves it, or that a patch covers, is marked so."""
    while max(image.shape[:2]) >= 2 * size and min(image.shape[:2]) >= 2:
        image, pixels = _halved(image), 0.5 * (pixels - 0.5)
    side = max(image.shape[:2])
    turn = np.deg2rad(spread.rotation_deg) * np.clip(rng.standard_normal(), -2.0, 2.0)
    zoom = size / side * np.exp(spread.scale * np.clip(rng.standard_normal(), -2.0, 2.0))
    A = zoom * np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    middle = 0.5 * (np.array(image.shape[1::-1]) - 1.0)
    b = 0.5 * (size - 1.0) + spread.shift * size * np.clip(rng.standard_normal(2), -2.0, 2.0) - A @ middle
    crop = np.array(warp_affine(image, np.column_stack([A, b]), (size, size)))
    moved = pixels @ A.T + b
    inside = np.all((moved > -0.5) & (moved < size - 0.5), axis=1)
    seen = np.where(inside, visibility, OUTSIDE)
    if rng.random() < spread.patches:
        corner = rng.uniform(-0.1, 1.0, 2) * size
        extent = rng.uniform(0.05, 0.3, 2) * size
        covered = np.all((moved >= corner) & (moved <= corner + extent), axis=1)
        seen = np.where(covered, np.minimum(seen, HIDDEN), seen)
        (u0, v0), (u1, v1) = np.ceil(np.clip([corner, corner + extent], 0, size)).astype(int)
        crop[v0:v1, u0:u1] = rng.integers(0, 256, 3) if rng.random() < 0.5 else rng.integers(0, 256)
    gain = np.exp(spread.colour * rng.standard_normal() + 0.3 * spread.colour * rng.standard_normal(3))
    offset = 100.0 * spread.colour * rng.standard_normal()
    values = crop * gain.astype(np.float32) + np.float32(offset)
    values += np.float32(spread.noise * rng.random()) * rng.standard_normal(crop.shape, dtype=np.float32)
    return np.clip(np.rint(values), 0, 255).astype(np.uint8), moved, seen.astype(np.int64)


def _halved(image: Image) -> Crop:
    """Means of four pixels: a warp that shrinks would skip three of them."""
    h, w = image.shape[0] // 2, image.shape[1] // 2
    even = image[: 2 * h, : 2 * w].reshape(h, 2, w, 2, 3).astype(np.uint16)
    return ((even[:, 0, :, 0] + even[:, 0, :, 1] + even[:, 1, :, 0] + even[:, 1, :, 1] + 2) // 4).astype(np.uint8)
