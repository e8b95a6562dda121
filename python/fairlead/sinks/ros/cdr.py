# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Serialisation of ROS 2 messages: plain CDR, little-endian. Source: OMG CORBA 3.3, part 2, section 9.3 (CDR)."""

import struct
from collections.abc import Iterable

_ENCAPSULATION = b"\x00\x01\x00\x00"
"""CDR, little-endian, no options."""
_SECONDS = 2**31 - 1


class CdrWriter:
    """Appends fields in their order; each number is aligned to its own size, counted from behind the encapsulation."""

    def __init__(self) -> None:
        self._data = bytearray()

    def _number(self, form: str, size: int, value: float | int) -> None:
        self._data += bytes(-len(self._data) % size) + struct.pack(f"<{form}", value)

    def int32(self, value: int) -> None:
        """A signed whole number."""
        self._number("i", 4, value)

    def uint32(self, value: int) -> None:
        """A whole number; also the length of a sequence."""
        self._number("I", 4, value)

    def uint8(self, value: int) -> None:
        """One byte."""
        self._number("B", 1, value)

    def float64(self, values: Iterable[float]) -> None:
        """Numbers one after another, as in an array of fixed length."""
        for value in values:
            self._number("d", 8, value)

    def string(self, text: str) -> None:
        """Text with its length and a zero at its end."""
        data = text.encode("utf-8") + b"\0"
        self.uint32(len(data))
        self._data += data

    def header(self, stamp_ns: int, frame_id: str) -> None:
        """std_msgs/Header. ROS counts seconds in 31 bits: stamps out of their range are put to its end."""
        stamp_ns = min(max(stamp_ns, 0), _SECONDS * 10**9)
        self.int32(stamp_ns // 10**9)
        self.uint32(stamp_ns % 10**9)
        self.string(frame_id)

    def finish(self) -> bytes:
        """The message with its encapsulation."""
        return _ENCAPSULATION + bytes(self._data)
