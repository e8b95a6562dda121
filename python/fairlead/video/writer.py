# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Images -> Matroska, each packet on its way to the disk when `write` returns."""

from fractions import Fraction
from pathlib import Path
from types import TracebackType
from typing import Any, Literal

import numpy as np
from jaxtyping import UInt8

Codec = Literal["h264", "ffv1"]
TIME_BASE = Fraction(1, 1000)
"""Of Matroska, which counts milliseconds [s]."""

_ENCODERS: dict[Codec, tuple[str, str, dict[str, str]]] = {
    "h264": ("libx264", "yuv420p", {"crf": "18", "preset": "veryfast", "tune": "zerolatency"}),
    "ffv1": ("ffv1", "bgr0", {"level": "3", "g": "1"}),
}
_MUXER = {"flush_packets": "1", "cluster_time_limit": "1"}
"""A cluster an image: what is not in a finished cluster is lost when the process is killed."""


class VideoWriter:
    """One video stream in a Matroska file; `ffv1` keeps every bit. Raises OSError where it cannot be written."""

    def __init__(self, path: Path, *, codec: Codec = "h264") -> None:
        import av

        path.open("wb").close()  # an error that names the file
        self._path = path
        self._container: Any = av.open(str(path), "w", format="matroska", options=_MUXER)
        self._codec: Codec = codec
        self._stream: Any = None
        self._last = -1
        self._start_ns: int | None = None

    def write(self, image: UInt8[np.ndarray, "h w 3"], stamp_ns: int) -> None:
        """Append an image (blue, green, red). Stamps count from the first one; one that goes back follows at 1 ms."""
        import av

        if self._stream is None:
            self._stream = self._open_stream(image.shape[1], image.shape[0])
            self._start_ns = stamp_ns
        assert self._start_ns is not None
        frame = av.VideoFrame.from_ndarray(_even(image), format="bgr24")
        self._last = max(self._last + 1, round((stamp_ns - self._start_ns) / 1e6))
        frame.pts = self._last
        frame.time_base = TIME_BASE
        self._mux(frame)

    def _open_stream(self, width: int, height: int) -> Any:
        name, pixels, options = _ENCODERS[self._codec]
        stream = self._container.add_stream(name, rate=30, options=options)
        stream.width, stream.height = width + width % 2, height + height % 2
        stream.pix_fmt = pixels
        stream.codec_context.time_base = TIME_BASE
        return stream

    def _mux(self, frame: Any) -> None:
        try:
            for packet in self._stream.encode(frame):
                self._container.mux(packet)
        except OSError as error:
            raise OSError(error.errno, error.strerror, str(self._path)) from error

    def close(self) -> None:
        """Finish the file; safe to call twice."""
        if self._container is None:
            return
        container, self._container = self._container, None
        try:
            if self._stream is not None:
                for packet in self._stream.encode(None):
                    container.mux(packet)
        finally:
            container.close()

    def __enter__(self) -> "VideoWriter":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _even(image: np.ndarray) -> np.ndarray:
    """The image with its last row and column doubled where their number is odd, as most codecs want it."""
    height, width = image.shape[:2]
    if height % 2 or width % 2:
        image = np.pad(image, ((0, height % 2), (0, width % 2), (0, 0)), mode="edge")
    return np.ascontiguousarray(image)
