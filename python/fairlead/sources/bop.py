# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A BOP scene folder as a source of images: what `fairlead render` writes, and other people's data sets."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from fairlead.io.bop import read_bop, read_bop_cameras
from fairlead.io.errors import InputError
from fairlead.io.fields import nearest
from fairlead.sources.image_folder import SUFFIXES, ImageFolderSource
from fairlead.sources.source import ImageFrame
from fairlead.types import Camera, TruthPose

K_TOLERANCE_PX = 0.01
"""How far a scene's intrinsics may be from the camera's: a tenth of what the best detectors see."""
FOLDERS = ("rgb", "gray")


class BopSource:
    """Images of a scene folder in order of their numbers, which are the numbers of the frames.

    Stamps as for a folder of images: rgb/stamps.csv, else names, else `fps`. Raises InputError: no images, an image
    that has no camera, intrinsics that are not the camera's, and whatever ImageFolderSource raises.
    """

    def __init__(self, folder: Path, camera: Camera, *, fps: float | None = None) -> None:
        self._images = ImageFolderSource(image_folder(folder), camera, fps=fps)
        self._folder = folder
        path = folder / "scene_camera.json"
        self._numbers = read_bop_cameras(folder)
        for number, K in self._numbers.items():
            off = float(np.abs(K - camera.K).max())
            if off > K_TOLERANCE_PX:
                raise InputError(
                    path, f"frame {number}: cam_K differs from the camera by {off:.3g} px; expected its own"
                )

    def count(self) -> int:
        """Number of images."""
        return self._images.count()

    def listed(self) -> list[tuple[int, int, Path]]:
        """Frame, stamp [ns] and file of every image; none is opened. Raises InputError."""
        return [(self._number(path), stamp_ns, path) for _, stamp_ns, path in self._images.listed()]

    def __iter__(self) -> Iterator[ImageFrame]:
        for image in self._images:
            yield replace(image, frame=self._number(image.path))

    def _number(self, path: Path) -> int:
        stem = path.stem
        if not (stem.isascii() and stem.isdigit()) or int(stem) not in self._numbers:
            known = [f"{number:06d}" for number in self._numbers]
            raise InputError(path, f"scene_camera.json has no such frame; {nearest(stem, known[:1000])}")
        return int(stem)


def image_folder(folder: Path) -> Path:
    """Where the images of a scene folder lie. Raises InputError."""
    for name in FOLDERS:
        if (folder / name).is_dir():
            return folder / name
    raise InputError(folder, f"expected a folder {' or '.join(FOLDERS)} with images ({' '.join(SUFFIXES)})")


def bop_truth(
    folder: Path, camera: Camera, *, object_id: int | None = None, fps: float | None = None
) -> list[TruthPose]:
    """The true poses of a scene folder, with the stamps of its images. Raises InputError."""
    stamps = {image.frame: image.stamp_ns for image in BopSource(folder, camera, fps=fps)}
    return [
        TruthPose(frame=each.frame, stamp_ns=stamps[each.frame], T_camera_target=each.T_camera_target)
        for each in read_bop(folder, object_id)
        if each.frame in stamps
    ]
