# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Camera calibrations -> Camera: ROS camera_info, OpenCV, Kalibr (YAML) and COLMAP (text), docs/files.md.

All but COLMAP put pixel (0, 0) at the centre of the top-left pixel; COLMAP puts it at that pixel's top-left corner.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import cast

import numpy as np

from fairlead.io.documents import read_text, read_yaml
from fairlead.io.errors import InputError
from fairlead.io.fields import Fields, Table, nearest
from fairlead.types import DISTORTION_SIZE, Camera, CameraModel

_ROS_MODELS: dict[str, CameraModel] = {
    "": "pinhole",
    "none": "pinhole",
    "pinhole": "pinhole",
    "plumb_bob": "plumb_bob",
    "rational_polynomial": "rational_polynomial",
    "equidistant": "equidistant",
    "fisheye": "equidistant",
}
_KALIBR_MODELS: dict[str, CameraModel] = {"none": "pinhole", "radtan": "plumb_bob", "equidistant": "equidistant"}
_K_KEYS = ("camera_matrix", "cameraMatrix", "Camera_Matrix", "K", "M")
_D_KEYS = ("distortion_coefficients", "distCoeffs", "dist_coeffs", "Distortion_Coefficients", "D")
_WIDTH_KEYS = ("image_width", "image_Width", "width")
_HEIGHT_KEYS = ("image_height", "image_Height", "height")


def load_camera(path: Path | str, *, name: str | None = None) -> Camera:
    """Read a calibration; the format is recognised by its content (`.txt`: COLMAP).

    `name` chooses among several cameras of a Kalibr chain (cam0, cam1, ...) or a COLMAP file (its id).
    Raises InputError: file, line or key, what came, what was expected.
    """
    path = Path(path)
    if path.suffix == ".txt":
        return _load_colmap(path, name)
    document = read_yaml(path)
    cameras = {str(key): cast(object, value) for key, value in document.items() if _is_kalibr(value)}
    if cameras:
        chosen = _choose(list(cameras), name, path)
        return _load_kalibr(cameras[chosen], chosen, path)
    camera = _load_matrix_form(document, path)
    _choose([camera.name], name, path)
    return camera


def _is_kalibr(value: object) -> bool:
    return isinstance(value, Mapping) and "intrinsics" in value


def _choose(names: list[str], name: str | None, path: Path) -> str:
    if name is None and len(names) == 1:
        return names[0]
    if name is None:
        raise InputError(path, f"holds {len(names)} cameras ({', '.join(names[:8])}): say which one")
    if name not in names:
        raise InputError(path, f"no camera {name!r}; {nearest(name, names)}")
    return name


def _camera(
    path: Path, name: str, size: tuple[int, int], model: CameraModel, K: list[float], distortion: list[float]
) -> Camera:
    """K: fx, fy, cx, cy."""
    fx, fy, cx, cy = K
    matrix = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    fitted = fit_distortion(model, distortion, path)
    try:
        return Camera(name=name, width=size[0], height=size[1], model=model, K=matrix, distortion=fitted)
    except ValueError as error:
        raise InputError(path, str(error)) from error


def ros_camera(path: Path, name: str, size: tuple[int, int], model: str, K: list[float], D: list[float]) -> Camera:
    """The camera of a ROS CameraInfo message: size (width, height), K row by row. Raises InputError."""
    if model.lower() not in _ROS_MODELS:
        raise InputError(path, f"distortion model: got {model!r}; {nearest(model, set(_ROS_MODELS) - {''})}")
    if len(K) != 9 or K[1] != 0.0 or K[3] != 0.0 or K[6:] != [0.0, 0.0, 1.0]:
        raise InputError(path, f"K: expected fx 0 cx 0 fy cy 0 0 1, got {K}")
    return _camera(path, name, size, _ROS_MODELS[model.lower()], [K[0], K[4], K[2], K[5]], D)


def fit_distortion(model: CameraModel, coefficients: list[float], path: Path) -> np.ndarray:
    """The coefficients at the length of the model: missing ones are zero, surplus ones must be."""
    size = DISTORTION_SIZE[model]
    allowed = {"pinhole": range(15), "plumb_bob": range(15), "rational_polynomial": range(8, 15)}
    if len(coefficients) not in allowed.get(model, (4,)):
        raise InputError(path, f"distortion of {model}: expected {size} coefficients, got {len(coefficients)}")
    if any(coefficients[size:]):
        raise InputError(
            path, f"distortion of {model}: expected {size} coefficients, the rest zero, got {coefficients}"
        )
    return np.array((coefficients + [0.0] * size)[:size], dtype=np.float64)


def _load_matrix_form(document: Table, path: Path) -> Camera:
    """ROS camera_info (matrices as tables) and OpenCV (tagged matrices): K, distortion, size."""
    fields = Fields(document, list(document), path)
    K = _matrix(fields, _first(fields, _K_KEYS), path)
    if len(K) != 9 or K[1] != 0.0 or K[3] != 0.0 or K[6:] != [0.0, 0.0, 1.0]:
        raise InputError(path, f"{_first(fields, _K_KEYS)}: expected fx 0 cx 0 fy cy 0 0 1, got {K}")
    distortion_key = next((key for key in _D_KEYS if key in fields), None)
    distortion = [] if distortion_key is None else _matrix(fields, distortion_key, path)
    name = next((fields.text(key) for key in ("camera_name", "name") if key in fields), path.stem)
    size = (fields.integer(_first(fields, _WIDTH_KEYS)), fields.integer(_first(fields, _HEIGHT_KEYS)))
    return _camera(path, name, size, _matrix_form_model(fields, distortion), [K[0], K[4], K[2], K[5]], distortion)


def _matrix_form_model(fields: Fields, distortion: list[float]) -> CameraModel:
    """The named model; OpenCV names none: eight coefficients are rational, `fisheye_model` is equidistant."""
    if "distortion_model" in fields:
        model = fields.get("distortion_model")
        if not isinstance(model, str) or model.lower() not in _ROS_MODELS:
            raise fields.error("distortion_model", f"got {model!r}; {nearest(str(model), set(_ROS_MODELS) - {''})}")
        return _ROS_MODELS[model.lower()]
    if "fisheye_model" in fields and fields.get("fisheye_model"):
        return "equidistant"
    if not distortion:
        return "pinhole"
    return "rational_polynomial" if len(distortion) >= 8 else "plumb_bob"


def _first(fields: Fields, keys: tuple[str, ...]) -> str:
    key = next((key for key in keys if key in fields), None)
    if key is None:
        raise fields.error(keys[0], "missing: this is no camera_info, OpenCV or Kalibr calibration")
    return key


def _matrix(fields: Fields, key: str, path: Path) -> list[float]:
    value = fields.get(key)
    if isinstance(value, Mapping):
        return Fields(cast(object, value), ("rows", "cols", "data", "dt"), path, key).numbers("data")
    if isinstance(value, list) and value and all(isinstance(row, list) for row in cast(list[object], value)):
        rows = [cast(list[object], row) for row in cast(list[object], value)]
        return Fields({key: [item for row in rows for item in row]}, (key,), path).numbers(key)
    return fields.numbers(key)


def _load_kalibr(table: object, name: str, path: Path) -> Camera:
    fields = Fields(table, list(cast(Table, table)), path, name)
    if fields.text("camera_model") != "pinhole":
        raise fields.error("camera_model", f"expected pinhole, got {fields.text('camera_model')!r}")
    kind = fields.text("distortion_model")
    if kind not in _KALIBR_MODELS:
        raise fields.error("distortion_model", f"got {kind!r}; {nearest(kind, _KALIBR_MODELS)}")
    width, height = fields.numbers("resolution", 2)
    distortion = fields.numbers("distortion_coeffs") if "distortion_coeffs" in fields else []
    K = fields.numbers("intrinsics", 4)
    return _camera(path, name, (round(width), round(height)), _KALIBR_MODELS[kind], K, distortion)


_COLMAP: dict[str, tuple[CameraModel, str]] = {
    "SIMPLE_PINHOLE": ("pinhole", "f cx cy"),
    "PINHOLE": ("pinhole", "fx fy cx cy"),
    "SIMPLE_RADIAL": ("plumb_bob", "f cx cy k1"),
    "RADIAL": ("plumb_bob", "f cx cy k1 k2"),
    "OPENCV": ("plumb_bob", "fx fy cx cy k1 k2 p1 p2"),
    "FULL_OPENCV": ("rational_polynomial", "fx fy cx cy k1 k2 p1 p2 k3 k4 k5 k6"),
    "OPENCV_FISHEYE": ("equidistant", "fx fy cx cy k1 k2 k3 k4"),
}


def _load_colmap(path: Path, name: str | None) -> Camera:
    """cameras.txt: CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]. Half a pixel is taken off the principal point."""
    lines = [(number, line.split()) for number, line in enumerate(read_text(path).splitlines(), 1)]
    cameras = [(number, words) for number, words in lines if words and not words[0].startswith("#")]
    if not cameras:
        raise InputError(path, "expected a COLMAP cameras.txt, got no camera")
    ids = [words[0] for _, words in cameras]
    number, words = cameras[ids.index(_choose(ids, name, path))]
    if len(words) < 4 or words[1] not in _COLMAP:
        expected = f"expected CAMERA_ID MODEL WIDTH HEIGHT PARAMS[] with a model of {', '.join(_COLMAP)}"
        raise InputError(path, f"{expected}, got {' '.join(words[:4])!r}", line=number)
    model, parameters = _COLMAP[words[1]]
    keys = parameters.split()
    try:
        width, height = int(words[2]), int(words[3])
        values = [float(word) for word in words[4:]]
    except ValueError as error:
        raise InputError(path, f"expected numbers: {error}", line=number) from error
    if len(values) != len(keys):
        raise InputError(path, f"{words[1]}: expected {parameters}, got {len(values)} values", line=number)
    named = dict(zip(keys, values, strict=True))
    fx, fy = (named["f"], named["f"]) if "f" in named else (named["fx"], named["fy"])
    distortion = values[keys.index("cy") + 1 :]
    K = [fx, fy, named["cx"] - 0.5, named["cy"] - 0.5]
    return _camera(path, words[0], (width, height), model, K, distortion)


def save_camera(path: Path | str, camera: Camera) -> None:
    """Write the ROS camera_info form."""
    K = ", ".join(repr(value) for value in camera.K.ravel().tolist())
    distortion = ", ".join(repr(value) for value in camera.distortion.tolist())
    model = "plumb_bob" if camera.model == "pinhole" else camera.model
    if camera.model == "pinhole":
        distortion = "0.0, 0.0, 0.0, 0.0, 0.0"
    text = f"""image_width: {camera.width}
image_height: {camera.height}
camera_name: {json.dumps(camera.name)}
camera_matrix:
  rows: 3
  cols: 3
  data: [{K}]
distortion_model: {model}
distortion_coefficients:
  rows: 1
  cols: {max(5, camera.distortion.size) if camera.model in ("pinhole", "plumb_bob") else camera.distortion.size}
  data: [{distortion}]
"""
    Path(path).write_text(text, encoding="utf-8", newline="\n")
