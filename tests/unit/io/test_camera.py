# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Camera files: every format gives the same camera, wrong ones give one line."""

from pathlib import Path

import numpy as np
import pytest

from fairlead.io.camera import load_camera, save_camera
from fairlead.io.errors import InputError
from fairlead.types import Camera

ROS = """
image_width: 640
image_height: 480
camera_name: left
camera_matrix:
  rows: 3
  cols: 3
  data: [500.0, 0, 320.5, 0, 510.0, 240.5, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.1, 2e-2, 0.001, -1e-3, 0.003]
rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}
projection_matrix: {rows: 3, cols: 4, data: [500, 0, 320.5, 0, 0, 510, 240.5, 0, 0, 0, 1, 0]}
"""
OPENCV = """%YAML:1.0
---
calibration_time: "Mon 1 Jan 2024"
image_width: 640
image_height: 480
flags: 0
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 500., 0., 320.5, 0., 510., 240.5, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -1.0e-01, 2.0e-02, 1.0e-03, -1.0e-03, 3.0e-03 ]
avg_reprojection_error: 3.2e-01
"""
KALIBR = """
cam0:
  camera_model: pinhole
  distortion_coeffs: [0.01, -0.02, 0.003, -0.0004]
  distortion_model: equidistant
  intrinsics: [500.0, 510.0, 320.5, 240.5]
  resolution: [640, 480]
  rostopic: /cam0/image_raw
cam1:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, 0.1]
  camera_model: pinhole
  distortion_coeffs: [-0.1, 0.02, 0.001, -0.001]
  distortion_model: radtan
  intrinsics: [501.0, 511.0, 321.5, 241.5]
  resolution: [640, 480]
"""
COLMAP = """# Camera list with one line of data per camera:
#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]
1 SIMPLE_RADIAL 640 480 500 321 241 -0.1
2 OPENCV 640 480 500 510 321 241 -0.1 0.02 0.001 -0.001
3 FULL_OPENCV 640 480 500 510 321 241 0.3 0.1 0.001 -0.002 0.01 0.5 0.1 0.02
4 OPENCV_FISHEYE 640 480 500 510 321 241 0.01 -0.02 0.003 -0.0004
5 SIMPLE_PINHOLE 640 480 500 321 241
6 PINHOLE 640 480 500 510 321 241
7 RADIAL 640 480 500 321 241 -0.1 0.02
8 FOV 640 480 500 510 321 241 0.9
"""


def write(folder: Path, text: str, name: str = "camera.yaml") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def numbers(camera: Camera) -> list[float]:
    return [camera.K[0, 0], camera.K[1, 1], camera.K[0, 2], camera.K[1, 2]]


def test_ros_and_opencv_agree(tmp_path: Path) -> None:
    ros = load_camera(write(tmp_path, ROS))
    opencv = load_camera(write(tmp_path, OPENCV, "opencv.yml"))
    assert ros.name == "left"
    assert opencv.name == "opencv"
    for camera in (ros, opencv):
        assert (camera.width, camera.height, camera.model) == (640, 480, "plumb_bob")
        assert numbers(camera) == [500.0, 510.0, 320.5, 240.5]
        assert camera.distortion.tolist() == [-0.1, 0.02, 0.001, -0.001, 0.003]


@pytest.mark.parametrize(
    ("model", "count", "expected"),
    [
        ("rational_polynomial", 8, "rational_polynomial"),
        ("equidistant", 4, "equidistant"),
        ("fisheye", 4, "equidistant"),
    ],
)
def test_other_ros_models(tmp_path: Path, model: str, count: int, expected: str) -> None:
    coefficients = [0.01 * (index + 1) for index in range(count)]
    text = ROS.replace("plumb_bob", model).replace("[-0.1, 2e-2, 0.001, -1e-3, 0.003]", str(coefficients))
    camera = load_camera(write(tmp_path, text))
    assert camera.model == expected
    assert camera.distortion.tolist() == coefficients


def test_opencv_models_go_by_the_coefficients(tmp_path: Path) -> None:
    def with_coefficients(count: int, zeros: int = 0) -> str:
        data = [*range(1, count + 1), *([0] * zeros)]
        text = OPENCV.replace("[ -1.0e-01, 2.0e-02, 1.0e-03, -1.0e-03, 3.0e-03 ]", str(data))
        return text.replace("rows: 5", f"rows: {count + zeros}")

    eight = load_camera(write(tmp_path, with_coefficients(8)))
    assert eight.model == "rational_polynomial"
    padded = load_camera(write(tmp_path, with_coefficients(8, zeros=4)))
    assert padded.distortion.tolist() == eight.distortion.tolist()
    fisheye = with_coefficients(4).replace("flags: 0", "fisheye_model: 1")
    assert load_camera(write(tmp_path, fisheye)).model == "equidistant"
    with pytest.raises(InputError, match="the rest zero"):
        load_camera(write(tmp_path, with_coefficients(9, zeros=3)))


def test_kalibr_chain(tmp_path: Path) -> None:
    path = write(tmp_path, KALIBR)
    first, second = load_camera(path, name="cam0"), load_camera(path, name="cam1")
    assert first.model == "equidistant"
    assert first.distortion.tolist() == [0.01, -0.02, 0.003, -0.0004]
    assert second.model == "plumb_bob"
    assert second.distortion.tolist() == [-0.1, 0.02, 0.001, -0.001, 0.0]
    assert numbers(second) == [501.0, 511.0, 321.5, 241.5]
    with pytest.raises(InputError, match=r"holds 2 cameras \(cam0, cam1\)"):
        load_camera(path)
    with pytest.raises(InputError, match="no camera 'cam7'"):
        load_camera(path, name="cam7")


def test_colmap_pixels_are_shifted_by_half(tmp_path: Path) -> None:
    path = write(tmp_path, COLMAP, "cameras.txt")
    for name in "1234567":
        camera = load_camera(path, name=name)
        assert camera.K[0, 2] == 320.5
        assert camera.K[1, 2] == 240.5
    assert load_camera(path, name="1").distortion.tolist() == [-0.1, 0.0, 0.0, 0.0, 0.0]
    assert numbers(load_camera(path, name="1")) == [500.0, 500.0, 320.5, 240.5]
    assert numbers(load_camera(path, name="2")) == [500.0, 510.0, 320.5, 240.5]
    assert load_camera(path, name="2").distortion.tolist() == [-0.1, 0.02, 0.001, -0.001, 0.0]
    assert load_camera(path, name="3").model == "rational_polynomial"
    assert load_camera(path, name="4").model == "equidistant"
    assert load_camera(path, name="6").model == "pinhole"
    with pytest.raises(InputError, match=r"cameras.txt:10: expected CAMERA_ID MODEL"):
        load_camera(path, name="8")
    with pytest.raises(InputError, match="holds 8 cameras"):
        load_camera(path)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("", "got no camera"),
        ("1 PINHOLE 640 480 500 510 321", "expected fx fy cx cy, got 3 values"),
        ("1 PINHOLE 640 x 500 510 321 241", "expected numbers"),
        ("1 PINHOLE 0 480 500 510 321 241", "positive width"),
        ("1 PINHOLE 640 480 nan 510 321 241", "finite"),
        ("1 PINHOLE", "expected CAMERA_ID MODEL"),
    ],
)
def test_wrong_colmap_lines(tmp_path: Path, line: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        load_camera(write(tmp_path, line, "cameras.txt"))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("image_width: 640", "", "image_width: missing"),
        ("image_width: 640", "image_width: 640.5", "image_width: expected a whole number"),
        ("image_width: 640", "image_width: -1", "positive width and height"),
        ("image_width: 640", "image_width: 640\nimage_width: 320", ":3: malformed YAML: key 'image_width' comes twice"),
        ("camera_matrix", "camera_matrxi", "camera_matrix: missing: this is no camera_info"),
        ("data: [500.0, 0,", "data: [500.0, 0.1,", "expected fx 0 cx 0 fy cy 0 0 1"),
        ("data: [500.0, 0,", "data: [0,", "camera_matrix: expected fx 0 cx"),
        ("data: [500.0, 0,", "data: [.nan, 0,", "camera_matrix.data: expected finite numbers"),
        ("data: [500.0, 0,", "data: [-500.0, 0,", "positive focal lengths"),
        ("data: [500.0, 0,", "data: [wide, 0,", "camera_matrix.data: expected finite numbers"),
        ("plumb_bob", "plumbob", "distortion_model: got 'plumbob'; did you mean 'plumb_bob'?"),
        ("plumb_bob", "[1]", "distortion_model: got [1]"),
        ("plumb_bob", "equidistant", "expected 4 coefficients, got 5"),
        ("plumb_bob", "rational_polynomial", "expected 8 coefficients, got 5"),
        ("plumb_bob", "pinhole", "the rest zero"),
        ("camera_name: left", "camera_name: {a: *x}", "aliases are not allowed"),
        ("camera_name: left", "camera_name: " + "[" * 40 + "]" * 40, "nested deeper than 32"),
        ("camera_name: left", "camera_name: !!python/object/apply:os.system ['true']", "malformed YAML"),
        ("camera_name: left", "camera_name: [", "malformed YAML"),
        ("camera_name: left", "camera_name: 2020-99-99", "malformed YAML"),
        ("camera_name: left", "a: &x [1]\nb: [*x]", "aliases are not allowed"),
        ("rows: 1", "row: 1", "distortion_coefficients.row: unknown key; did you mean 'rows'?"),
    ],
)
def test_wrong_ros_files(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in ROS
    path = write(tmp_path, ROS.replace(old, new, 1))
    with pytest.raises(InputError) as caught:
        load_camera(path)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "matrix",
    ["!!opencv-matrix [1, 2]", "!!opencv-matrix {rows: 3, cols: 3}", "!!opencv-matrix {rows: 2, cols: 2, data: [1]}"],
)
def test_wrong_opencv_matrices(tmp_path: Path, matrix: str) -> None:
    path = write(tmp_path, f"image_width: 4\nimage_height: 4\ncamera_matrix: {matrix}\n")
    with pytest.raises(InputError, match=r"camera\.yaml:3: malformed YAML: .*OpenCV matrix"):
        load_camera(path)


@pytest.mark.parametrize("text", ["", "3", "- 1\n- 2\n", "a: b: c", "\x00", "{{}: 1}", "? [1]\n: 2", "9" * 5000])
def test_what_is_no_calibration(tmp_path: Path, text: str) -> None:
    with pytest.raises(InputError):
        load_camera(write(tmp_path, text))


@pytest.mark.parametrize(
    ("model", "count"), [("pinhole", 0), ("plumb_bob", 5), ("rational_polynomial", 8), ("equidistant", 4)]
)
def test_what_is_written_is_read_back(tmp_path: Path, model: str, count: int) -> None:
    K = np.array([[1.0 / 3.0, 0.0, 320.1], [0.0, 7e2 / 3.0, 1e-5], [0.0, 0.0, 1.0]])
    camera = Camera(name='a "b": c', width=3, height=2, model=model, K=K, distortion=np.arange(count) / 7.0)
    save_camera(tmp_path / "c.yaml", camera)
    again = load_camera(tmp_path / "c.yaml")
    assert again.name == camera.name
    assert np.array_equal(again.K, K)
    expected = np.zeros(5) if model == "pinhole" else camera.distortion
    assert np.array_equal(again.distortion, expected)
