# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Cameras of this machine."""

from collections.abc import Generator, Iterator
from contextlib import contextmanager

import numpy as np

from fairlead.opencv.images import Image


@contextmanager
def open_capture(number: int, width: int, height: int) -> Generator[Iterator[Image] | None]:
    """Images of a camera (V4L2 on Linux) until it gives no more; None where there is no such camera.

    The size is asked for; the driver may give another.
    """
    import cv2

    capture = cv2.VideoCapture(number)
    try:
        if not capture.isOpened():
            yield None
            return
        capture.set(cv2.CAP_PROP_FRAME_WIDTH, width)
        capture.set(cv2.CAP_PROP_FRAME_HEIGHT, height)
        capture.set(cv2.CAP_PROP_BUFFERSIZE, 1)
        yield _images(capture)
    finally:
        capture.release()


def _images(capture: object) -> Iterator[Image]:
    while True:
        good, image = capture.read()  # pyright: ignore[reportAttributeAccessIssue]
        if not good or image is None:
            return
        yield np.asarray(image)
