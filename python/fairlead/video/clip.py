# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Clips that are kept: exact stamps, marked colours, small rather than quick. docs/rendering.md section 10."""

from fractions import Fraction
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from jaxtyping import UInt8

CLIP = "clip.mkv"
"""The film of a sequence, in the folder of its truth."""
TICK_NS = 1_000_000
"""Matroska counts milliseconds."""
_X264 = {"preset": "slow", "psy": "0", "aq-mode": "0", "threads": "1"}
"""Every bit against the difference, none for the eye: a third less landmark error at the same size.

One thread, since the bits depend on their number.
"""
_BT601, _LIMITED, _SRGB = 6, 1, 13
"""Matrix and primaries, range 16..235, transfer, by their numbers in ITU-T H.273."""
_RED, _GREEN, _BLUE = 0.299, 0.587, 0.114
"""What the primaries weigh in brightness, ITU-R BT.601."""


def yuv420(image: UInt8[np.ndarray, "h w 3"]) -> UInt8[np.ndarray, "planes w"]:
    """Brightness, and under it blue and red difference at half the size, docs/rendering.md eq. (8).

    Not by FFmpeg's scaler: at its default it rounds down, which darkens by 1 to 2 levels.
    """
    blue, green, red = np.moveaxis(image.astype(np.float32), 2, 0)
    bright = _RED * red + _GREEN * green + _BLUE * blue
    planes = [16.0 + (219.0 / 255.0) * bright]
    for colour, weight in ((blue, _BLUE), (red, _RED)):
        difference = (colour - bright) / (2.0 * (1.0 - weight))
        quarters = difference.reshape(image.shape[0] // 2, 2, image.shape[1] // 2, 2)
        planes.append(128.0 + (224.0 / 255.0) * quarters.mean(axis=(1, 3)))
    flat = np.concatenate([plane.ravel() for plane in planes])
    return np.round(flat).astype(np.uint8).reshape(-1, image.shape[1])


class ClipWriter:
    """Writes pictures of one size, even in width and height, with stamps that rise by whole milliseconds.

    Colours are coded by BT.601 in the range 16..235 and marked so; a reader that ignores the mark takes the same.
    H.264; `crf` is x264's constant quality: 0 to 51, less is better and larger. `rate_hz` is for players.
    Raises ValueError for another size or stamp, OSError where the file cannot be written.
    """

    def __init__(self, path: Path, width: int, height: int, *, rate_hz: Fraction, crf: float) -> None:
        if width % 2 or height % 2 or min(width, height) < 2:
            raise ValueError(f"clip: expected an even width and height, got {width} x {height}")
        import av

        self._size = (width, height)
        self._last = -1
        self._container: Any = av.open(str(path), "w", format="matroska")
        self._stream: Any = self._container.add_stream("libx264", rate=rate_hz, options={**_X264, "crf": f"{crf:g}"})
        self._stream.width, self._stream.height, self._stream.pix_fmt = width, height, "yuv420p"
        context = self._stream.codec_context
        context.time_base = Fraction(TICK_NS, 10**9)
        context.colorspace = context.color_primaries = _BT601
        context.color_range, context.color_trc = _LIMITED, _SRGB

    def write(self, image: UInt8[np.ndarray, "h w 3"], stamp_ns: int) -> None:
        """Add one picture (blue, green, red), to be shown at `stamp_ns`."""
        import av

        if image.shape != (self._size[1], self._size[0], 3):
            raise ValueError(f"clip: expected {self._size[0]} x {self._size[1]}, got an array of {image.shape}")
        tick, rest = divmod(stamp_ns, TICK_NS)
        if rest or tick <= self._last:
            raise ValueError(f"clip: expected a stamp of whole ms after {self._last} ms, got {stamp_ns} ns")
        self._last = tick
        frame: Any = av.VideoFrame.from_ndarray(yuv420(image), format="yuv420p")
        frame.colorspace, frame.color_range = _BT601, _LIMITED
        frame.pts, frame.time_base = tick, Fraction(TICK_NS, 10**9)
        self._container.mux(self._stream.encode(frame))

    def close(self) -> None:
        """Write what the encoder still holds."""
        self._container.mux(self._stream.encode(None))
        self._container.close()

    def __enter__(self) -> "ClipWriter":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def video_stamps(path: Path) -> list[int]:
    """Stamps of all pictures of a clip in order [ns], without decoding any."""
    import av

    with av.open(str(path)) as container:
        packets: Any = [packet for packet in container.demux(container.streams.video[0]) if packet.size > 0]
        return sorted(round(packet.pts * packet.time_base * 10**9) for packet in packets)
