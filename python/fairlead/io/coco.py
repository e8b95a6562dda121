# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""COCO keypoint files: labels of images for training detectors. docs/files.md.

Keypoints are x, y, v with (0, 0) at the **centre** of the top-left pixel, as everywhere here; v is 0 outside the image,
1 hidden, 2 visible. Beside COCO's own keys each annotation holds `K` and `T_camera_target` (metres).
"""

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from fairlead.io.documents import read_text
from fairlead.io.errors import InputError
from fairlead.types import Matrix3, Matrix4, Pixels

MAX_BYTES = 1024 * 1024 * 1024


@dataclass(frozen=True, kw_only=True, eq=False)
class LabelledImage:
    """One image with one target."""

    number: int
    file_name: str
    width: int
    height: int
    pixels: Pixels
    """(n, 2), order as in the categories; 0 where v is 0."""
    visibility: tuple[int, ...]
    """0 outside, 1 hidden, 2 visible."""
    box: tuple[float, float, float, float]
    """x, y, width, height of the target in the image [px]."""
    K: Matrix3
    T_camera_target: Matrix4


def label_json(image: LabelledImage) -> dict[str, Any]:
    """An annotation, with its image under `image`."""
    table = np.column_stack([image.pixels, image.visibility])
    keypoints = [round(float(value), 4) for value in np.nan_to_num(table).ravel()]
    keypoints[2::3] = [int(value) for value in keypoints[2::3]]
    return {
        "id": image.number,
        "image_id": image.number,
        "category_id": 1,
        "bbox": [round(float(value), 2) for value in image.box],
        "area": round(float(image.box[2] * image.box[3]), 2),
        "iscrowd": 0,
        "keypoints": keypoints,
        "num_keypoints": sum(v > 0 for v in image.visibility),
        "K": image.K.ravel().tolist(),
        "T_camera_target": image.T_camera_target.ravel().tolist(),
        "image": {"id": image.number, "file_name": image.file_name, "width": image.width, "height": image.height},
    }


def write_coco(
    path: Path, name: str, landmarks: Sequence[str], labels: Iterable[dict[str, Any]], *, made: str = "rendered by"
) -> None:
    """Write annotations.json from what `label_json` made, in order of the images' numbers; whole or not at all."""
    ordered = sorted(labels, key=lambda label: cast(int, label["id"]))
    images = [label["image"] for label in ordered]
    annotations = [{key: value for key, value in label.items() if key != "image"} for label in ordered]
    document = {
        "info": {"description": f"{name}, {made} fairlead", "pixel_0_0": "centre of the top-left pixel"},
        "categories": [{"id": 1, "name": name, "keypoints": list(landmarks), "skeleton": []}],
        "images": images,
        "annotations": annotations,
    }
    part = path.with_name(f".{path.name}.part")
    part.write_text(json.dumps(document), encoding="utf-8")
    part.replace(path)


def read_coco(path: Path) -> tuple[tuple[str, ...], list[LabelledImage]]:
    """Names of the keypoints, and the images with one annotation each. Raises InputError."""
    try:
        document = json.loads(read_text(path, MAX_BYTES))
        names = tuple(str(name) for name in document["categories"][0]["keypoints"])
        images = {image["id"]: image for image in document["images"]}
        return names, [_labelled(images[each["image_id"]], each, len(names)) for each in document["annotations"]]
    except (ValueError, KeyError, TypeError, IndexError, RecursionError) as error:
        if isinstance(error, InputError):
            raise
        what = f"{type(error).__name__}: {error}"
        raise InputError(path, f"expected COCO keypoints with K and T_camera_target, got {what}") from error


def _labelled(image: dict[str, Any], annotation: dict[str, Any], count: int) -> LabelledImage:
    table = np.array(annotation["keypoints"], dtype=np.float64).reshape(count, 3)
    x, y, width, height = (float(value) for value in annotation["bbox"])
    return LabelledImage(
        number=int(image["id"]),
        file_name=str(image["file_name"]),
        width=int(image["width"]),
        height=int(image["height"]),
        pixels=table[:, :2].copy(),
        visibility=tuple(int(v) for v in table[:, 2]),
        box=(x, y, width, height),
        K=np.array(annotation["K"], dtype=np.float64).reshape(3, 3),
        T_camera_target=np.array(annotation["T_camera_target"], dtype=np.float64).reshape(4, 4),
    )
