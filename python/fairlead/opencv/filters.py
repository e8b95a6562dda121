# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Filters and encoders for images that are made here; those that come from outside are in images.py."""

from pathlib import Path

import numpy as np
from jaxtyping import Float32, Float64, UInt8, UInt16

Light = Float32[np.ndarray, "h w c"]


def blurred(image: Light, sigma_px: float) -> Light:
    """Gaussian blur; the image goes on beyond its edges as its mirror."""
    import cv2

    if sigma_px <= 0.0:
        return image
    # Large blurs at a quarter of the size: 16 times less work, and 1 % of the result.
    if sigma_px > 12.0 and min(image.shape[:2]) >= 64:
        small = resized(image, image.shape[1] // 4, image.shape[0] // 4)
        return resized(blurred(small, 0.25 * sigma_px), image.shape[1], image.shape[0])
    return np.array(cv2.GaussianBlur(image, (0, 0), sigma_px), np.float32).reshape(image.shape)


def resized(image: Light, width: int, height: int) -> Float32[np.ndarray, "rows columns c"]:
    """Pixel centres kept: half a pixel from the edge stays half a pixel of the new size. Area mean when smaller."""
    import cv2

    smaller = width * height < image.shape[0] * image.shape[1]
    result = cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA if smaller else cv2.INTER_LINEAR)
    return np.array(result, np.float32).reshape(height, width, image.shape[2])


def warp_affine(
    image: UInt8[np.ndarray, "h w 3"], A: Float64[np.ndarray, "2 3"], size: tuple[int, int], border: int = 114
) -> UInt8[np.ndarray, "rows columns 3"]:
    """The image moved by z' = A (z, 1), size (width, height); bilinear; grey where the image does not reach.

    Pixel centres are whole numbers on both sides. A shrinking A is not smoothed here.
    """
    import cv2

    grey = (border, border, border)
    return np.asarray(cv2.warpAffine(image, A, size, flags=cv2.INTER_LINEAR, borderValue=grey))


def streaks(
    shape: tuple[int, int], starts: np.ndarray, ends: np.ndarray, widths_px: np.ndarray, weights: np.ndarray
) -> Float32[np.ndarray, "h w"]:
    """Anti-aliased line segments, (n, 2) px each, drawn to 1/16 px; overlapping ones take the larger weight."""
    import cv2

    layer = np.zeros(shape, np.float32)
    scale = 16.0
    first, last = (np.clip(p * scale, -1e6, 1e6).astype(int).tolist() for p in (starts, ends))
    thick = np.maximum(1, np.round(widths_px)).astype(int).tolist()
    for start, end, width, weight in zip(first, last, thick, weights.tolist(), strict=True):
        cv2.line(layer, start, end, weight, width, cv2.LINE_AA, 4)
    return layer


def write_image(path: Path, image: UInt8[np.ndarray, "h w *c"] | UInt16[np.ndarray, "h w"], quality: int = 95) -> None:
    """PNG (8 bits, or 16 of one channel) or JPEG by the name's suffix, channels blue green red; whole or not at all.

    Raises OSError where it cannot be written.
    """
    import cv2

    lossy = path.suffix.lower() in (".jpg", ".jpeg")
    options = [cv2.IMWRITE_JPEG_QUALITY, quality] if lossy else [cv2.IMWRITE_PNG_COMPRESSION, 3]
    done, data = cv2.imencode(path.suffix, image, options)
    if not done:
        raise ValueError(f"{path}: no encoder for {image.dtype} {image.shape}")
    part = path.with_name(f".{path.name}.part")
    part.write_bytes(data.tobytes())
    part.replace(path)


def encode_png(image: UInt8[np.ndarray, "h w *c"]) -> bytes:
    """A PNG of 8 bits a channel, channels blue green red, quickly rather than small."""
    import cv2

    done, data = cv2.imencode(".png", image, [cv2.IMWRITE_PNG_COMPRESSION, 1])
    if not done:
        raise ValueError(f"no encoder for {image.dtype} {image.shape}")
    return data.tobytes()
