# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Size of an image from its bytes, without decoding, and whether the file was cut short.

Formats: PNG (W3C PNG 3, section 5), JPEG (ITU-T T.81, annex B), BMP, TIFF 6.0, WebP (RFC 9649), Netpbm.
"""

import re
import struct
import zlib
from collections.abc import Callable
from typing import Literal

_JPEG_ALONE = {0x01, *range(0xD0, 0xD8)}
_JPEG_FRAMES = {*range(0xC0, 0xD0)} - {0xC4, 0xC8, 0xCC}
_NETPBM = re.compile(rb"P([2356])(?:\s|#[^\n]*\n)+(\d{1,9})(?:\s|#[^\n]*\n)+(\d{1,9})(?:\s|#[^\n]*\n)+(\d{1,5})\s")
_TIFF_MAX_ENTRIES = 1000


class HeaderError(ValueError):
    """Not an image that can be read, with what is wrong."""


def image_header(data: bytes) -> tuple[int, int]:
    """Width and height [px]. Raises HeaderError for unknown formats, damaged structure and files cut short."""
    for magic, offset, parser in _PARSERS:
        if data[offset : offset + len(magic)] == magic:
            try:
                return parser(data)
            except (struct.error, IndexError) as error:
                raise HeaderError("the image is cut short") from error
    if _NETPBM.match(data):
        return _netpbm(data)
    raise HeaderError("expected an image (PNG, JPEG, BMP, TIFF, WebP, PGM or PPM), got something else")


def _png(data: bytes) -> tuple[int, int]:
    position, size = 8, (0, 0)
    while True:
        length, kind = struct.unpack_from(">I4s", data, position)
        body = memoryview(data)[position + 4 : position + 8 + length]
        (checksum,) = struct.unpack_from(">I", data, position + 8 + length)
        if position == 8:
            if kind != b"IHDR":
                raise HeaderError("expected a PNG, its first chunk is not IHDR")
            size = struct.unpack_from(">II", data, position + 8)
        if zlib.crc32(body) != checksum:
            raise HeaderError("the PNG is damaged: wrong checksum")
        if kind == b"IEND":
            return size
        position += 12 + length


def _jpeg(data: bytes) -> tuple[int, int]:
    position, size = 2, None
    while True:
        if data[position] != 0xFF:
            raise HeaderError("the JPEG is damaged: expected a marker")
        marker = data[position + 1]
        if marker == 0xFF or marker in _JPEG_ALONE:
            position += 1 if marker == 0xFF else 2
            continue
        (length,) = struct.unpack_from(">H", data, position + 2)
        if length < 2:
            raise HeaderError("the JPEG is damaged: empty segment")
        if marker in _JPEG_FRAMES:
            height, width = struct.unpack_from(">HH", data, position + 5)
            size = (width, height)
        position += 2 + length
        if marker == 0xDA:
            break
    if size is None:
        raise HeaderError("the JPEG is damaged: no size before the data")
    if data.find(b"\xff\xd9", position) < 0:
        raise HeaderError("the JPEG is cut short")
    return size


def _bmp(data: bytes) -> tuple[int, int]:
    (offset, header) = struct.unpack_from("<II", data, 10)
    if header < 40:
        raise HeaderError("expected a BMP of version 3 or later")
    width, height, _, bits, compression = struct.unpack_from("<iiHHI", data, 18)
    stride = (max(width, 0) * bits + 31) // 32 * 4
    if compression in (0, 3) and len(data) < offset + stride * abs(height):
        raise HeaderError(f"the BMP is cut short: too few bytes for {width} x {abs(height)} pixels")
    return width, abs(height)


def _tiff(data: bytes) -> tuple[int, int]:
    order: Literal["<", ">"] = "<" if data[:2] == b"II" else ">"
    (directory,) = struct.unpack_from(order + "I", data, 4)
    (entries,) = struct.unpack_from(order + "H", data, directory)
    values: dict[int, int] = {}
    for entry in range(min(entries, _TIFF_MAX_ENTRIES)):
        tag, kind, count = struct.unpack_from(order + "HHI", data, directory + 2 + 12 * entry)
        if tag in (256, 257) and count == 1 and kind in (3, 4):
            (values[tag],) = struct.unpack_from(order + ("H" if kind == 3 else "I"), data, directory + 10 + 12 * entry)
    if len(values) != 2:
        raise HeaderError("the TIFF is damaged: it does not tell its size")
    return values[256], values[257]


def _webp(data: bytes) -> tuple[int, int]:
    (length,) = struct.unpack_from("<I", data, 4)
    if len(data) < 8 + length:
        raise HeaderError("the WebP is cut short")
    kind = data[12:16]
    if kind == b"VP8X":
        return int.from_bytes(data[24:27], "little") + 1, int.from_bytes(data[27:30], "little") + 1
    if kind == b"VP8L":
        (bits,) = struct.unpack_from("<I", data, 21)
        return (bits & 0x3FFF) + 1, (bits >> 14 & 0x3FFF) + 1
    if kind == b"VP8 ":
        width, height = struct.unpack_from("<HH", data, 26)
        return width & 0x3FFF, height & 0x3FFF
    raise HeaderError("expected a WebP with VP8, VP8L or VP8X")


def _netpbm(data: bytes) -> tuple[int, int]:
    match = _NETPBM.match(data)
    if match is None:
        raise HeaderError("the PGM or PPM is damaged")
    kind, width, height, largest = (int(group) for group in match.groups())
    samples = width * height * (3 if kind in (3, 6) else 1) * (2 if largest > 255 else 1)
    if kind >= 5 and len(data) - match.end() < samples <= 2**31:
        raise HeaderError("the PGM or PPM is cut short")
    return width, height


_PARSERS: tuple[tuple[bytes, int, Callable[[bytes], tuple[int, int]]], ...] = (
    (b"\x89PNG\r\n\x1a\n", 0, _png),
    (b"\xff\xd8\xff", 0, _jpeg),
    (b"BM", 0, _bmp),
    (b"II*\x00", 0, _tiff),
    (b"MM\x00*", 0, _tiff),
    (b"WEBP", 8, _webp),
)
