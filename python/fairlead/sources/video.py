# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Video files, and live streams from the network."""

import time
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit, urlunsplit

from fairlead.io.errors import InputError
from fairlead.sources.live import LiveImages, check_size
from fairlead.sources.source import ImageFrame
from fairlead.types import Camera
from fairlead.video import count_pictures, open_video, pictures, video_size

SUFFIXES = (".mkv", ".mp4", ".avi", ".mov", ".m4v", ".webm", ".ts", ".mts", ".mpg", ".mpeg", ".wmv", ".h264", ".h265")
SCHEMES = ("rtsp", "rtsps", "rtmp", "udp", "tcp", "http", "https", "srt", "rtp")


class VideoSource:
    """Every image of a video file, with the stamps of its container.

    Where the container has no stamps, `fps` makes them. Raises InputError: no video, images of another size than the
    camera's, no stamps, and damage, after every image before it.
    """

    def __init__(self, path: Path, camera: Camera, *, fps: float | None = None) -> None:
        self._path, self._camera, self._fps = path, camera, fps
        with open_video(path) as container:
            check_size(str(path), video_size(container), (camera.width, camera.height))

    def count(self) -> int:
        """Number of images."""
        with open_video(self._path) as container:
            return count_pictures(container)

    def __iter__(self) -> Iterator[ImageFrame]:
        with open_video(self._path) as container:
            for frame, picture in enumerate(pictures(container, named=str(self._path))):
                height, width = picture.image.shape[:2]
                check_size(str(self._path), (width, height), (self._camera.width, self._camera.height))
                stamp_ns = picture.stamp_ns
                if stamp_ns is None and self._fps is None:
                    raise InputError(self._path, "the video carries no stamps: give --fps")
                if stamp_ns is None:
                    assert self._fps is not None
                    stamp_ns = round(frame * 1e9 / self._fps)
                yield ImageFrame(frame=frame, stamp_ns=stamp_ns, path=self._path, image=picture.image)


def stream_source(address: str, camera: Camera) -> LiveImages:
    """A live stream: its own stamps on this machine's monotonic clock, by the image that took the least time to come.

    Raises InputError (without the password of the address) where it cannot be opened or breaks off.
    """
    return LiveImages(without_password(address), lambda: _grab(address, camera))


def _grab(address: str, camera: Camera) -> Iterator[ImageFrame]:
    name = without_password(address)
    offset_ns: int | None = None
    last_ns = -(2**63)
    with open_video(address, named=name) as container:
        for frame, picture in enumerate(pictures(container, named=name)):
            height, width = picture.image.shape[:2]
            check_size(name, (width, height), (camera.width, camera.height))
            now_ns = time.monotonic_ns()
            stamp_ns = now_ns
            if picture.stamp_ns is not None:
                late_ns = now_ns - picture.stamp_ns
                offset_ns = late_ns if offset_ns is None else min(offset_ns, late_ns)
                stamp_ns = picture.stamp_ns + offset_ns
            last_ns = max(last_ns + 1, stamp_ns)
            yield ImageFrame(frame=frame, stamp_ns=last_ns, path=Path(name), image=picture.image)


def without_password(address: str) -> str:
    """The address as it may be shown and recorded."""
    parts = urlsplit(address)
    if "@" not in parts.netloc:
        return address
    return urlunsplit(parts._replace(netloc="***@" + parts.netloc.rpartition("@")[2]))
