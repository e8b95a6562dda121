# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""BOP scene folders <-> frames with poses: millimetres there, metres here. docs/files.md.

The format is that of the BOP benchmark for 6D object pose estimation: scene_camera.json, scene_gt.json,
scene_gt_info.json beside rgb/, depth/, mask/, mask_visib/. Pixel (0, 0) is the centre of the top-left pixel there, too.
"""

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from fairlead.io.documents import read_text
from fairlead.io.errors import InputError
from fairlead.types import Matrix3, Matrix4, is_rigid

MAX_BYTES = 256 * 1024 * 1024
MM_PER_M = 1000.0

Box = tuple[int, int, int, int]
"""x, y of the top-left pixel, width, height [px]; -1 where there is nothing."""


@dataclass(frozen=True, kw_only=True, eq=False)
class BopFrame:
    """One image of a scene folder and one object in it."""

    frame: int
    """Number of the image, which is its name."""
    K: Matrix3
    T_camera_target: Matrix4
    """Metres."""
    object_id: int = 1
    depth_scale: float = 1.0
    """Value in the depth image times this is millimetres."""
    pixels_all: int = -1
    """Of the silhouette, as if nothing were in front of it; -1 if not known."""
    pixels_visible: int = -1
    box_all: Box = (-1, -1, -1, -1)
    box_visible: Box = (-1, -1, -1, -1)


def write_bop(folder: Path, frames: Iterable[BopFrame]) -> None:
    """Write the three JSON files of a scene folder."""
    cameras: dict[str, Any] = {}
    poses: dict[str, Any] = {}
    infos: dict[str, Any] = {}
    for each in frames:
        key = str(each.frame)
        T = each.T_camera_target
        cameras[key] = {"cam_K": each.K.ravel().tolist(), "depth_scale": each.depth_scale}
        translation = (MM_PER_M * T[:3, 3]).tolist()
        poses[key] = [{"cam_R_m2c": T[:3, :3].ravel().tolist(), "cam_t_m2c": translation, "obj_id": each.object_id}]
        share = each.pixels_visible / each.pixels_all if each.pixels_all > 0 else 0.0
        infos[key] = [
            {
                "bbox_obj": list(each.box_all),
                "bbox_visib": list(each.box_visible),
                "px_count_all": each.pixels_all,
                "px_count_valid": each.pixels_all,
                "px_count_visib": each.pixels_visible,
                "visib_fract": min(share, 1.0),
            }
        ]
    for name, table in (("scene_camera", cameras), ("scene_gt", poses), ("scene_gt_info", infos)):
        lines = ",\n".join(f"  {json.dumps(key)}: {json.dumps(value)}" for key, value in table.items())
        (folder / f"{name}.json").write_text("{\n" + lines + "\n}\n", encoding="utf-8")


def is_bop(folder: Path) -> bool:
    """Whether a folder is a scene folder."""
    return (folder / "scene_camera.json").is_file()


def read_bop(folder: Path, object_id: int | None = None) -> list[BopFrame]:
    """Frames in order of their numbers, with the pose of one object (the only one, if not told which).

    Frames without that object are left out. Raises InputError: file, frame, what came, what was expected.
    """
    cameras, poses = (_table(folder / f"scene_{name}.json") for name in ("camera", "gt"))
    path = folder / "scene_gt.json"
    known = {entry.get("obj_id") for entries in poses.values() for entry in _entries(entries, path)}
    if object_id is None:
        if len(known) != 1:
            raise InputError(path, f"expected one object, got {sorted(map(str, known))}: say which")
        object_id = cast(int, next(iter(known)))
    frames: list[BopFrame] = []
    for key in sorted(poses, key=lambda text: _number(text, path)):
        found = [entry for entry in _entries(poses[key], path) if entry.get("obj_id") == object_id]
        if len(found) > 1:
            raise InputError(path, f"frame {key}: expected object {object_id} once, got it {len(found)} times")
        if key not in cameras:
            raise InputError(folder / "scene_camera.json", f"has no frame {key}, which scene_gt.json has")
        frames += [_frame(folder, key, cameras[key], entry, object_id) for entry in found]
    return frames


def read_bop_cameras(folder: Path) -> dict[int, Matrix3]:
    """K of every image, by its number. Raises InputError."""
    path = folder / "scene_camera.json"
    return {_number(key, path): _intrinsics(entry, key, path) for key, entry in _table(path).items()}


def _frame(folder: Path, key: str, camera: object, entry: Mapping[str, Any], object_id: int) -> BopFrame:
    path = folder / "scene_gt.json"
    T = np.eye(4)
    T[:3, :3] = _numbers(entry, "cam_R_m2c", 9, key, path).reshape(3, 3)
    T[:3, 3] = _numbers(entry, "cam_t_m2c", 3, key, path) / MM_PER_M
    # Files are written with few decimals: the nearest rotation is meant.
    U, singular, Vt = np.linalg.svd(T[:3, :3])
    if np.abs(singular - 1.0).max() > 1e-3 or np.linalg.det(T[:3, :3]) < 0.0:
        raise InputError(path, f"frame {key}: cam_R_m2c: expected a rotation, got {T[:3, :3].ravel().tolist()}")
    T[:3, :3] = U @ Vt
    assert is_rigid(T)
    at = folder / "scene_camera.json"
    scale = cast(Mapping[str, Any], camera).get("depth_scale", 1.0) if isinstance(camera, Mapping) else 1.0
    return BopFrame(
        frame=_number(key, path),
        K=_intrinsics(camera, key, at),
        T_camera_target=T,
        object_id=object_id,
        depth_scale=float(scale) if isinstance(scale, int | float) else 1.0,
    )


def _intrinsics(entry: object, key: str, path: Path) -> Matrix3:
    if not isinstance(entry, Mapping):
        raise InputError(path, f"frame {key}: expected a table, got {type(entry).__name__}")
    return _numbers(cast(Mapping[str, Any], entry), "cam_K", 9, key, path).reshape(3, 3)


def _table(path: Path) -> dict[str, Any]:
    try:
        table = json.loads(read_text(path, MAX_BYTES))
    except (json.JSONDecodeError, RecursionError) as error:
        line = error.lineno if isinstance(error, json.JSONDecodeError) else None
        raise InputError(path, f"malformed JSON: {str(error).splitlines()[0]}", line=line) from error
    if not isinstance(table, dict) or not table:
        raise InputError(path, "expected a table of frames by number")
    return cast(dict[str, Any], table)


def _entries(value: object, path: Path) -> Sequence[Mapping[str, Any]]:
    if not isinstance(value, list) or not all(isinstance(entry, Mapping) for entry in cast(list[object], value)):
        raise InputError(path, "expected a list of objects for each frame")
    return cast(Sequence[Mapping[str, Any]], value)


def _number(text: str, path: Path) -> int:
    if not (text.isascii() and text.isdigit() and len(text) < 16):
        raise InputError(path, f"expected the number of a frame, got {text[:40]!r}")
    return int(text)


def _numbers(entry: Mapping[str, Any], name: str, count: int, key: str, path: Path) -> np.ndarray:
    value = entry.get(name)
    try:
        numbers = np.array(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(path, f"frame {key}: {name}: expected {count} numbers") from error
    if numbers.shape != (count,) or not np.isfinite(numbers).all():
        raise InputError(path, f"frame {key}: {name}: expected {count} finite numbers, got {str(value)[:80]}")
    return numbers
