# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""ROS recordings as a source of images: CompressedImage or Image, and the CameraInfo beside them."""

import logging
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import takewhile
from pathlib import Path
from typing import Any

import numpy as np

from fairlead import opencv
from fairlead.io.camera import ros_camera
from fairlead.io.errors import InputError
from fairlead.io.fields import nearest
from fairlead.sources.live import check_size
from fairlead.sources.messages import Message, Topic, messages, topics
from fairlead.sources.source import Image, ImageFrame
from fairlead.types import Camera

_log = logging.getLogger(__name__)

WARN_PX = 0.5
"""A larger difference between the given calibration and that of the recording is reported."""
_IMAGES = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage")
_INFO = "sensor_msgs/msg/CameraInfo"
_CHANNELS = {"bgr8": 3, "rgb8": 3, "8UC3": 3, "mono8": 1, "8UC1": 1, "bgra8": 4, "rgba8": 4}


class BagSource:
    """Images of one topic with the stamps of their headers.

    Raises InputError: no images or several topics of them, images of another size than the camera's or of an encoding
    that is not known, and damage, after every image before it.
    """

    def __init__(self, path: Path, camera: Camera, *, topic: str | None = None) -> None:
        self._path, self._camera = path, camera
        found = topics(path)
        self._topic = image_topic(path, found, topic)
        self._count = found[self._topic].count
        self._compare(found)

    def _compare(self, found: Mapping[str, Topic]) -> None:
        """Say so where the recording's own calibration is another one."""
        told = _recorded_camera(self._path, found, self._topic)
        if told is None:
            return
        ours = self._camera
        check_size(str(self._path), (told.width, told.height), (ours.width, ours.height))
        off = float(np.abs(told.K - ours.K).max())
        if off > WARN_PX:
            _log.warning("%s: its CameraInfo differs from the camera by %.3g px; the camera is used", self._path, off)

    def count(self) -> int:
        """Number of images; 0 where the recording does not say."""
        return self._count

    def __iter__(self) -> Iterator[ImageFrame]:
        for frame, message in enumerate(messages(self._path, [self._topic])):
            image = _image(message, self._path)
            size = (image.shape[1], image.shape[0])
            check_size(str(self._path), size, (self._camera.width, self._camera.height))
            yield ImageFrame(frame=frame, stamp_ns=_stamp_ns(message), path=self._path, image=image)


def image_topic(path: Path, found: Mapping[str, Topic], wanted: str | None) -> str:
    """The topic that the images come from. Raises InputError."""
    names = [name for name, topic in found.items() if _ros2_name(topic.kind) in _IMAGES]
    if not names:
        raise InputError(path, f"holds no images; its topics: {', '.join(sorted(found)[:8]) or 'none'}")
    if wanted is not None and wanted not in names:
        raise InputError(path, f"holds no images under {wanted!r}; {nearest(wanted, names)}")
    if wanted is None and len(names) > 1:
        raise InputError(path, f"holds images under {', '.join(sorted(names)[:8])}: say which with --topic")
    return wanted or names[0]


def bag_camera(path: Path, *, topic: str | None = None) -> Camera:
    """The calibration that a recording brings along. Raises InputError where it has none."""
    found = topics(path)
    camera = _recorded_camera(path, found, image_topic(path, found, topic))
    if camera is None:
        raise InputError(path, "holds no calibrated CameraInfo: expected --camera too")
    return camera


def _recorded_camera(path: Path, found: Mapping[str, Topic], images: str) -> Camera | None:
    """From the CameraInfo whose name has most in common with that of the images; None if it was never calibrated."""
    names = [name for name, topic in found.items() if _ros2_name(topic.kind) == _INFO]
    if not names:
        return None
    name = max(names, key=lambda each: _in_common(each, images))
    message = next(messages(path, [name]), None)
    if message is None:
        return None
    info = message.content
    K, D = (_numbers(info, key) for key in ("k", "d"))
    if not any(K):
        return None
    camera = ros_camera(path, "camera", (int(info.width), int(info.height)), str(info.distortion_model), K, D)
    return replace(camera, name=str(info.header.frame_id) or "camera")


def _in_common(a: str, b: str) -> int:
    """Parts that two names share from their beginning."""
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(a.split("/"), b.split("/"), strict=False)))


def _numbers(info: Any, key: str) -> list[float]:
    """ROS 1 wrote these names in capitals."""
    values = getattr(info, key, None)
    return [float(value) for value in (getattr(info, key.upper(), ()) if values is None else values)]


def _ros2_name(kind: str) -> str:
    return kind if "/msg/" in kind else kind.replace("/", "/msg/", 1)


def _stamp_ns(message: Message) -> int:
    """Of the header; of the recording where the header has none."""
    stamp = message.content.header.stamp
    return int(stamp.sec) * 10**9 + int(stamp.nanosec) or message.log_ns


def _image(message: Message, path: Path) -> Image:
    content = message.content
    if hasattr(content, "format"):
        return opencv.decode_image(bytes(content.data), None, path)
    encoding, height, width, step = str(content.encoding), int(content.height), int(content.width), int(content.step)
    if encoding not in _CHANNELS:
        raise InputError(path, f"image encoding {encoding!r}: expected one of {', '.join(_CHANNELS)}")
    channels = _CHANNELS[encoding]
    data = np.frombuffer(bytes(content.data), np.uint8)
    if step < width * channels or data.size != step * height or not data.size:
        raise InputError(path, f"image of {width} x {height} {encoding}: got {data.size} bytes, {step} a row")
    pixels = data.reshape(height, step)[:, : width * channels].reshape(height, width, channels)
    if channels == 1:
        return np.repeat(pixels, 3, axis=2)
    colours = pixels[..., :3]
    return np.ascontiguousarray(colours[..., ::-1] if encoding.startswith("rgb") else colours)
