# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Which source of images a path or an address is, docs/pipeline.md section 2."""

from pathlib import Path

from fairlead.io.bop import is_bop
from fairlead.io.errors import InputError
from fairlead.sources.bop import BopSource
from fairlead.sources.image_folder import SUFFIXES as IMAGE_SUFFIXES
from fairlead.sources.image_folder import ImageFolderSource
from fairlead.sources.source import ImageSource
from fairlead.types import Camera

KINDS = (
    "observations (.csv, .parquet), a folder of images, a BOP scene, a video, a bag or .mcap, camera:0 or rtsp://..."
)
BAG_SUFFIXES = (".mcap", ".bag", ".db3")


def is_live(source: Path | str) -> bool:
    """Whether images come when they come, and not when they are asked for."""
    return isinstance(source, str)


def is_bag(path: Path) -> bool:
    """Whether this is a recording of messages."""
    return path.suffix.lower() in BAG_SUFFIXES or (path / "metadata.yaml").is_file()


def open_images(source: Path | str, camera: Camera, *, fps: float | None, topic: str | None) -> ImageSource:
    """The images of a source that has them. Raises InputError."""
    if isinstance(source, str):
        return _open_live(source, camera)
    if is_bag(source):
        from fairlead.sources.bag import BagSource

        return BagSource(source, camera, topic=topic)
    if source.is_dir():
        kind = BopSource if is_bop(source) else ImageFolderSource
        return kind(source, camera, fps=fps)
    if not source.exists():
        raise InputError(source, f"is not there; expected {KINDS}")
    if source.suffix.lower() in IMAGE_SUFFIXES:
        raise InputError(source, "is one image; expected a folder of them")
    from fairlead.sources.video import VideoSource

    return VideoSource(source, camera, fps=fps)


def _open_live(name: str, camera: Camera) -> ImageSource:
    from fairlead.sources.usb import PREFIX, usb_source
    from fairlead.sources.video import SCHEMES, stream_source

    if name.startswith(PREFIX):
        return usb_source(name, camera)
    scheme = name.partition("://")[0]
    if scheme not in SCHEMES:
        raise InputError(name, f"expected an address with one of {', '.join(SCHEMES)}")
    return stream_source(name, camera)
