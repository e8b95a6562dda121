# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What every detector is, and which one a specification names: docs/fiducials.md section 1, docs/detect.md."""

from pathlib import Path
from typing import Protocol, runtime_checkable

from fairlead.detect.fiducial import BoardDetector, CharucoBoard, Chessboard, TagDetector
from fairlead.io.shipped import shipped_network
from fairlead.opencv import Image
from fairlead.types import Camera, Correlation, Estimate, Target, View

FORMS = "network.onnx, frigate, aruco:DICT_4X4_100, apriltag:36h11, charuco:7x5:DICT_5X5_100[:0.75], chessboard:9x6"
NETWORK_SUFFIX = ".onnx"


@runtime_checkable
class Detector(Protocol):
    """Finds the landmarks of a target in an image."""

    @property
    def correlation(self) -> Correlation:
        """How long its errors stay."""
        ...

    def detect(self, image: Image, frame: int, stamp_ns: int) -> View:
        """The landmarks seen in one image (blue, green, red); an empty view where there are none."""
        ...

    def follow(self, estimate: Estimate) -> None:
        """What the estimator made of the last view. A detector that always looks everywhere has no use for it."""
        ...


def detector_from_spec(spec: str, target: Target | None = None, camera: Camera | None = None) -> Detector:
    """A detector from its specification, which is one of FORMS.

    With a target, only its landmarks are reported; networks need it, and the camera. Raises ValueError for another
    specification, an unknown family, a board that cannot be, or a target none of whose landmarks the detector can see;
    InputError for the file of a network that cannot be used.
    """
    path = Path(spec) if spec.endswith(NETWORK_SUFFIX) else shipped_network(spec)
    if path is not None:
        if target is None or camera is None:
            raise ValueError(f"detector: expected a target and a camera beside network {path.name}")
        from fairlead.detect.network import NetworkDetector

        return NetworkDetector(path, target, camera)
    kind, _, rest = spec.partition(":")
    if kind == "aruco" and rest:
        return TagDetector(rest, target)
    if kind == "apriltag" and rest:
        return TagDetector(f"DICT_APRILTAG_{rest}", target)
    if kind == "charuco":
        size, _, family = rest.partition(":")
        family, _, ratio = family.partition(":")
        return BoardDetector(CharucoBoard(*_size(size, spec), family=family, marker_ratio=_ratio(ratio, spec)), target)
    if kind == "chessboard":
        return BoardDetector(Chessboard(*_size(rest, spec)), target)
    raise ValueError(f"detector: expected one of {FORMS}, got {spec!r}")


def _size(text: str, spec: str) -> tuple[int, int]:
    columns, _, rows = text.partition("x")
    if not (columns.isdecimal() and rows.isdecimal() and 2 <= int(columns) <= 100 and 2 <= int(rows) <= 100):
        raise ValueError(f"detector: expected a board of 2x2 to 100x100 in {spec!r}, got {text!r}")
    return int(columns), int(rows)


def _ratio(text: str, spec: str) -> float:
    try:
        ratio = float(text or "0.75")
    except ValueError:
        ratio = float("nan")
    if not 0.0 < ratio < 1.0:
        raise ValueError(f"detector: expected tag side / square side between 0 and 1 in {spec!r}, got {text!r}")
    return ratio
