# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A camera of this machine: `camera:0`."""

import time
from collections.abc import Iterator
from pathlib import Path

from fairlead import opencv
from fairlead.io.errors import InputError
from fairlead.sources.live import LiveImages, check_size
from fairlead.sources.source import ImageFrame
from fairlead.types import Camera

PREFIX = "camera:"


def usb_source(name: str, camera: Camera) -> LiveImages:
    """Images of the camera with this number, at the size of the calibration; stamps of the monotonic clock.

    Raises InputError: no such camera, another size, or it went away.
    """
    number = name.removeprefix(PREFIX)
    if not (number.isascii() and number.isdigit() and len(number) < 4):
        raise InputError(name, "expected camera: and a number, as in camera:0")
    return LiveImages(name, lambda: _grab(name, int(number), camera))


def _grab(name: str, number: int, camera: Camera) -> Iterator[ImageFrame]:
    with opencv.open_capture(number, camera.width, camera.height) as capture:
        if capture is None:
            raise InputError(name, "no such camera")
        for frame, image in enumerate(capture):
            stamp_ns = time.monotonic_ns()
            check_size(name, (image.shape[1], image.shape[0]), (camera.width, camera.height))
            yield ImageFrame(frame=frame, stamp_ns=stamp_ns, path=Path(name), image=image)
    raise InputError(name, "gives no more images")
