# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Images from files. Size and completeness are read from the file itself before OpenCV sees a byte of it."""

from pathlib import Path

import numpy as np
from jaxtyping import UInt8

from fairlead.io.errors import InputError
from fairlead.opencv.header import HeaderError, image_header

Image = UInt8[np.ndarray, "h w 3"]
"""Blue, green, red."""
GreyImage = UInt8[np.ndarray, "h w"]

MAX_PIXELS = 2**27
"""A larger image is refused: 134 million pixels take 400 MB once decoded."""
MAX_BYTES = 2**28
"""A larger file is refused [bytes]."""


def image_size(path: Path) -> tuple[int, int]:
    """Width and height [px] from the header; nothing is decoded.

    Raises InputError: not an image, cut short, empty, or more than MAX_PIXELS.
    """
    return _checked(path)[1]


def read_image(path: Path) -> Image:
    """Decode to 8 bits a channel, in the order blue, green, red; pixel (0, 0) is the centre of the top-left one.

    The orientation tag of a photograph is ignored: pixels stay where the sensor, and so the calibration, has them.
    Raises InputError as `image_size` does, and if decoding fails.
    """
    return decode_image(*_checked(path), path)


def decode_image(data: bytes, size: tuple[int, int] | None, named: Path) -> Image:
    """As `read_image` from the bytes of a file; the size (width, height) is that of its header, None: not read yet."""
    import cv2

    width, height = _header(data, named) if size is None else size
    try:
        image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR | cv2.IMREAD_IGNORE_ORIENTATION)
    except cv2.error as error:
        raise InputError(named, "expected an image, the decoder failed") from error
    if image is None or image.shape != (height, width, 3) or image.dtype != np.uint8:
        raise InputError(named, f"expected an image of {width} x {height} as its header says, the decoder failed")
    return np.asarray(image)


def grey(image: np.ndarray) -> GreyImage:
    """Luminance 0.299 r + 0.587 g + 0.114 b of an 8 bit image with one or three channels.

    Raises ValueError for another shape or type, or an empty image.
    """
    import cv2

    _check(image)
    return image if image.ndim == 2 else np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY))


def coloured(image: np.ndarray) -> Image:
    """The same image with three channels, as a grey file is read. Raises ValueError as `grey`."""
    _check(image)
    return image if image.ndim == 3 else np.repeat(image[:, :, None], 3, axis=2)


def _check(image: np.ndarray) -> None:
    if image.dtype != np.uint8 or image.size == 0 or (image.ndim != 2 and image.shape[2:] != (3,)):
        raise ValueError(f"image: expected 8 bits, (h, w) or (h, w, 3), got {image.dtype} {image.shape}")


def _checked(path: Path) -> tuple[bytes, tuple[int, int]]:
    try:
        if path.stat().st_size > MAX_BYTES:
            raise InputError(path, f"expected at most {MAX_BYTES} bytes, got {path.stat().st_size}")
        data = path.read_bytes()
    except OSError as error:
        raise InputError(path, f"cannot be read: {error.strerror}") from error
    return data, _header(data, path)


def _header(data: bytes, named: Path) -> tuple[int, int]:
    try:
        width, height = image_header(data)
    except HeaderError as error:
        raise InputError(named, str(error)) from error
    if width <= 0 or height <= 0 or width * height > MAX_PIXELS:
        raise InputError(named, f"expected an image of 1 to {MAX_PIXELS} pixels, got {width} x {height}")
    return width, height
