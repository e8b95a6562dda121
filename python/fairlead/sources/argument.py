# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A source as it stands on the command line."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.constructors import PrimitiveConstructorSpec


def parse_source(text: str) -> Path | str:
    """A path, or the name of something live as it is."""
    return text if "://" in text or text.startswith("camera:") else Path(text)


Source = Annotated[
    Path | str,
    PrimitiveConstructorSpec(
        nargs=1,
        metavar="SOURCE",
        instance_from_str=lambda words: parse_source(words[0]),
        is_instance=lambda value: isinstance(value, Path | str),
        str_from_instance=lambda value: [str(value)],
    ),
]
"""A path, or text for what is live: `camera:0`, `rtsp://...`."""


@dataclass(frozen=True, kw_only=True)
class ImageOptions:
    """What images need to be told where they do not say it themselves."""

    camera: Path | None = None
    """Calibration: ROS camera_info, OpenCV or Kalibr YAML, COLMAP cameras.txt. A bag may bring its own."""
    detector: str | None = None
    """What finds the landmarks in images, e.g. network.onnx, frigate (shipped), aruco:DICT_4X4_100, apriltag:36h11."""
    fps: float | None = None
    """Frames per second of images without stamps [1/s]."""
    topic: str | None = None
    """Which images of a bag that holds several."""
    camera_name: str | None = None
    """Which camera of a file that holds several."""
