# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A folder of images as a source, sorted by name, docs/files.md."""

import re
from collections.abc import Iterator
from pathlib import Path

from fairlead import opencv
from fairlead.io.csv_lines import integer_cell, read_csv
from fairlead.io.errors import InputError
from fairlead.io.paths import resolve_inside
from fairlead.sources.source import ImageFrame
from fairlead.types import Camera

SUFFIXES = (".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp", ".pgm", ".ppm")

_SECONDS = re.compile(r"([0-9]{10})(?:\.([0-9]{1,9}))?")
_NANOSECONDS = re.compile(r"[0-9]{19}")


class ImageFolderSource:
    """Images of one folder that all have the size of the camera.

    The stamp of an image comes from `stamps.csv` in the folder (`image,stamp_ns`), else from its name (ten digits of
    seconds, decimals allowed, or nineteen of nanoseconds), else from its place in the sequence and `fps`.
    Raises InputError: no images, no stamps, an image outside the folder, unreadable or of another size.
    """

    def __init__(self, folder: Path, camera: Camera, *, fps: float | None = None) -> None:
        self._folder = folder
        self._camera = camera
        self._images = _stamped_images(folder, fps)

    def count(self) -> int:
        """Number of images."""
        return len(self._images)

    def listed(self) -> list[tuple[int, int, Path]]:
        """Frame, stamp [ns] and file of every image; none is opened."""
        return [(frame, stamp_ns, path) for frame, (path, stamp_ns) in enumerate(self._images)]

    def __iter__(self) -> Iterator[ImageFrame]:
        for frame, (path, stamp_ns) in enumerate(self._images):
            width, height = opencv.image_size(path)
            if (width, height) != (self._camera.width, self._camera.height):
                expected = f"expected {self._camera.width} x {self._camera.height} as the camera has"
                raise InputError(path, f"{expected}, got an image of {width} x {height}")
            yield ImageFrame(frame=frame, stamp_ns=stamp_ns, path=path, image=opencv.read_image(path))


def _stamped_images(folder: Path, fps: float | None) -> list[tuple[Path, int]]:
    table = folder / "stamps.csv"
    if table.exists():
        rows = [
            (resolve_inside(folder, cells["image"], table), integer_cell(cells, "stamp_ns", table, line))
            for line, cells in read_csv(table, ("image", "stamp_ns"))
        ]
        if not rows:
            raise InputError(table, "names no image")
        return rows
    names = sorted(path.name for path in folder.iterdir() if path.suffix.lower() in SUFFIXES)
    if not names:
        raise InputError(folder, f"holds no image ({' '.join(SUFFIXES)})")
    paths = [resolve_inside(folder, name, folder) for name in names]
    stamps = [stamp_of_name(Path(name).stem) for name in names]
    known = [stamp for stamp in stamps if stamp is not None]
    if fps is None and len(known) == len(names):
        return list(zip(paths, known, strict=True))
    if fps is None:
        raise InputError(folder, "the images carry no stamps (stamps.csv, or names in s or ns): give --fps")
    if not 0.0 < fps < 1e6:
        raise ValueError(f"fps: expected a positive number of frames per second, got {fps}")
    return [(path, round(index * 1e9 / fps)) for index, path in enumerate(paths)]


def stamp_of_name(stem: str) -> int | None:
    """Stamp [ns] of a file name that is a time since 1970, in seconds or nanoseconds; None otherwise."""
    if _NANOSECONDS.fullmatch(stem):
        return int(stem) if int(stem) < 2**63 else None
    match = _SECONDS.fullmatch(stem)
    if match is None:
        return None
    return int(match[1]) * 10**9 + int((match[2] or "").ljust(9, "0"))
