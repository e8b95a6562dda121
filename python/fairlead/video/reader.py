# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Video files and network streams -> images with the stamps of their container."""

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import UInt8

from fairlead.io.errors import InputError

OPEN_TIMEOUT_S = 10.0
READ_TIMEOUT_S = 5.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Picture:
    """One decoded image."""

    stamp_ns: int | None
    """Presentation time of the container; None where it has none."""
    image: UInt8[np.ndarray, "h w 3"]
    """Blue, green, red."""


_LIVE = {"fflags": "nobuffer", "flags": "low_delay", "analyzeduration": "500000", "probesize": "200000"}
"""Begin at once, keep nothing back."""


_TEXT_ART = ("ansi", "bintext", "idf", "xbin")
"""Codecs with which FFmpeg draws the letters of a text file."""


def open_video(source: Path | str, *, named: str | None = None) -> Any:
    """Open a file, or a network address if it is text; `named` stands for it in messages. Raises InputError."""
    import av
    from av.error import FFmpegError

    name = named or str(source)
    live = isinstance(source, str)
    options = _LIVE if live else {}
    if live and source.startswith("rtsp"):
        options = options | {"rtsp_transport": "tcp"}
    try:
        container = av.open(str(source), options=options, timeout=(OPEN_TIMEOUT_S, READ_TIMEOUT_S))
    except (FFmpegError, OSError, ValueError) as error:
        raise InputError(name, f"no readable video: {_said(error)}") from error
    if not container.streams.video:
        container.close()
        raise InputError(name, "holds no video")
    if container.streams.video[0].codec_context.name in _TEXT_ART:
        container.close()
        raise InputError(name, "is text; expected a video")
    # Threads over frames hold back as many images as there are threads.
    container.streams.video[0].thread_type = "SLICE" if live else "AUTO"
    return container


def video_size(container: Any) -> tuple[int, int]:
    """Width and height [px] of an open video."""
    stream = container.streams.video[0]
    return int(stream.codec_context.width), int(stream.codec_context.height)


def count_pictures(container: Any) -> int:
    """Number of images of an open video: as its container says, else by reading it through without decoding."""
    from av.error import FFmpegError

    stream = container.streams.video[0]
    if stream.frames:
        return int(stream.frames)
    count = 0
    with contextlib.suppress(FFmpegError, OSError):
        for packet in container.demux(stream):
            count += packet.size > 0
    return count


def pictures(container: Any, *, named: str) -> Iterator[Picture]:
    """Decode to the end. Raises InputError where the data are damaged, after every image before that."""
    from av.error import FFmpegError

    stream = container.streams.video[0]
    shown = 0
    try:
        for packet in container.demux(stream):
            if packet.is_corrupt:
                raise InputError(named, f"damaged after {shown} images")
            for frame in packet.decode():
                if frame.is_corrupt:
                    raise InputError(named, f"damaged after {shown} images")
                shown += 1
                yield Picture(stamp_ns=_stamp_ns(frame), image=frame.to_ndarray(format="bgr24"))
    except (FFmpegError, OSError) as error:
        raise InputError(named, f"damaged after {shown} images: {_said(error)}") from error


def _stamp_ns(frame: Any) -> int | None:
    if frame.pts is None or frame.time_base is None:
        return None
    return round(frame.pts * frame.time_base * 10**9)


def _said(error: Exception) -> str:
    text = getattr(error, "strerror", None) or str(error)
    return str(text).splitlines()[0] if text else type(error).__name__
