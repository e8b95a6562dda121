# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""OpenCV's answers are checked, and no file reaches its decoders before its size is known."""

import struct
import subprocess
import sys
import zlib
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from fairlead import opencv
from fairlead.geometry import exp_se3, project, transform
from fairlead.io.errors import InputError
from fairlead.types import Camera, CameraModel

LENSES: dict[CameraModel, list[float]] = {
    "pinhole": [],
    "plumb_bob": [-0.2, 0.05, 1e-3, -2e-3, 0.01],
    "rational_polynomial": [0.1, 0.02, 1e-3, 1e-3, 0.01, 0.15, 0.03, 0.0],
    "equidistant": [0.02, -0.01, 0.001, 0.0],
}
T = exp_se3(np.array([0.1, -0.2, 9.0, 0.3, -0.5, 0.2]))
SOLVERS = [opencv.epnp, opencv.sqpnp]


def camera_of(model: CameraModel) -> Camera:
    K = np.array([[700.0, 0.0, 320.0], [0.0, 710.0, 240.0], [0.0, 0.0, 1.0]])
    return Camera(name="c", width=640, height=480, model=model, K=K, distortion=np.array(LENSES[model]))


@pytest.fixture
def points() -> np.ndarray:
    return np.random.default_rng(1).uniform(-2.0, 2.0, (12, 3))


@pytest.mark.parametrize("model", LENSES)
@pytest.mark.parametrize("solver", SOLVERS)
def test_exact_pixels_give_the_pose(solver: Callable, model: CameraModel, points: np.ndarray) -> None:
    camera = camera_of(model)
    (solution,) = solver(points, project(camera, transform(T, points)), camera)
    # EPnP on exact data keeps about 1e-5 of the range; the lens is inverted to 1e-9.
    np.testing.assert_allclose(solution.T_camera_target, T, atol=1e-3)
    assert solution.reprojection_rms_px < 0.05


def test_far_from_the_origin_epnp_keeps_its_digits(points: np.ndarray) -> None:
    camera, offset = camera_of("pinhole"), np.array([1e5, -2e5, 3e5])
    there = T.copy()
    there[:3, 3] -= T[:3, :3] @ offset
    (solution,) = opencv.epnp(points + offset, project(camera, transform(T, points)), camera)
    np.testing.assert_allclose(transform(solution.T_camera_target, points + offset), transform(T, points), atol=1e-2)


def test_a_plane_has_two_poses_the_right_one_first(points: np.ndarray) -> None:
    camera = camera_of("plumb_bob")
    flat = points * [1.0, 1.0, 0.0]
    solutions = opencv.ippe(flat, project(camera, transform(T, flat)), camera)
    assert len(solutions) == 2
    np.testing.assert_allclose(solutions[0].T_camera_target, T, atol=1e-6)
    assert solutions[1].reprojection_rms_px > solutions[0].reprojection_rms_px
    assert opencv.ippe(points, project(camera, transform(T, points)), camera) == ()


def test_refinement_reaches_the_minimum_and_leaves_its_arguments(points: np.ndarray) -> None:
    camera = camera_of("plumb_bob")
    pixels = project(camera, transform(T, points))
    guess = T @ exp_se3(np.array([0.1, -0.1, 0.2, 0.03, -0.02, 0.05]))
    arguments = [points, pixels, guess]
    before = [argument.copy() for argument in arguments]
    (solution,) = opencv.refine(points, pixels, camera, guess)
    np.testing.assert_allclose(solution.T_camera_target, T, atol=1e-6)
    for argument, copy in zip(arguments, before, strict=True):
        np.testing.assert_array_equal(argument, copy)


@pytest.mark.parametrize(
    "spoil",
    [
        lambda X, z: (X[:3], z[:3]),
        lambda X, z: (np.full_like(X, np.nan), z),
        lambda X, z: (X, np.full_like(z, np.inf)),
        lambda X, z: (X * [1.0, 0.0, 0.0], z),
        lambda X, z: (0.0 * X, z),
        lambda X, z: (X, 0.0 * z + 100.0),
        lambda X, z: (X[:0], z[:0]),
    ],
    ids=["three", "NaN points", "infinite pixels", "line", "one point", "one pixel", "none"],
)
def test_what_cannot_be_solved_has_no_answer(spoil: Callable, points: np.ndarray) -> None:
    camera = camera_of("pinhole")
    X, z = spoil(points, project(camera, transform(T, points)))
    for solver in (*SOLVERS, opencv.ippe):
        assert solver(X, z, camera) == ()
    assert opencv.refine(X, z, camera, T) == ()


def test_answers_are_always_in_front_rigid_and_finite() -> None:
    rng, camera = np.random.default_rng(2), camera_of("pinhole")
    for _ in range(200):
        n = int(rng.integers(4, 9))
        X = rng.standard_normal((n, 3)) * 10.0 ** rng.uniform(-3, 3, 3)
        z = rng.uniform(0.0, 640.0, (n, 2))
        for solver in (*SOLVERS, opencv.ippe):
            for solution in solver(X, z, camera):
                assert np.isfinite(solution.T_camera_target).all()
                assert (transform(solution.T_camera_target, X)[:, 2] > 0.0).all()
                assert np.linalg.det(solution.T_camera_target[:3, :3]) == pytest.approx(1.0, abs=1e-9)


def test_wrong_shapes_are_the_callers_mistake(points: np.ndarray) -> None:
    with pytest.raises((ValueError, TypeError)):
        opencv.epnp(points, np.zeros((3, 2)), camera_of("pinhole"))


def png(width: int, height: int) -> bytes:
    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"")) + chunk(b"IEND", b"")


@pytest.mark.parametrize("size", [(60000, 60000), (0, 10), (2**31, 2**31)])
def test_a_bomb_is_refused_by_its_header(
    tmp_path: Path, size: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "bomb.png"
    path.write_bytes(png(*size))
    monkeypatch.setattr(cv2, "imdecode", lambda *_: pytest.fail("it was decoded"))
    for read in (opencv.image_size, opencv.read_image):
        with pytest.raises(InputError, match=f"{size[0]} x {size[1]}"):
            read(path)


FORMATS = ["png", "jpg", "bmp", "tif", "webp", "ppm"]


@pytest.mark.parametrize("suffix", FORMATS)
def test_the_size_is_known_without_decoding(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"image.{suffix}"
    ramp = np.add.outer(np.arange(31), np.arange(57))[:, :, None] * np.array([1, 2, 0]) + [0, 0, 50]
    assert cv2.imwrite(str(path), ramp.astype(np.uint8))
    assert opencv.image_size(path) == (57, 31)
    image = opencv.read_image(path)
    assert image.shape == (31, 57, 3)
    assert np.abs(image.astype(int) - ramp).mean() < 4.0  # JPEG and WebP lose a little


@pytest.mark.parametrize("suffix", FORMATS)
def test_a_damaged_image_is_an_input_error_or_an_image(tmp_path: Path, suffix: str) -> None:
    rng, path = np.random.default_rng(3), tmp_path / f"image.{suffix}"
    cv2.imwrite(str(path), rng.integers(0, 255, (31, 57, 3), dtype=np.uint8))
    whole = path.read_bytes()
    for length in rng.integers(0, len(whole) * 9 // 10, 20):
        path.write_bytes(whole[:length])
        with pytest.raises(InputError):
            opencv.read_image(path)
    for _ in range(60):
        broken = bytearray(whole)
        for place in rng.integers(0, min(len(broken), 200), 3):
            broken[place] = rng.integers(0, 256)
        path.write_bytes(broken)
        try:
            assert opencv.read_image(path).dtype == np.uint8
        except InputError:
            continue


def test_the_orientation_tag_is_ignored(tmp_path: Path) -> None:
    path = tmp_path / "turned.jpg"
    cv2.imwrite(str(path), np.zeros((20, 40, 3), np.uint8))
    data = path.read_bytes()
    exif = b"Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0"
    path.write_bytes(data[:2] + b"\xff\xe1" + struct.pack(">H", len(exif) + 2) + exif + data[2:])
    assert opencv.read_image(path).shape == (20, 40, 3)


@pytest.mark.parametrize("content", [b"", b"hello", b"<svg/>", b"\x89PNG\r\n\x1a\n", b"BM"])
def test_what_is_no_image_is_an_input_error(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "x.png").write_bytes(content)
    with pytest.raises(InputError, match=r"x\.png"):
        opencv.image_size(tmp_path / "x.png")
    with pytest.raises(InputError, match="cannot be read"):
        opencv.image_size(tmp_path / "absent.png")


def test_cv2_is_imported_only_when_it_is_used() -> None:
    code = "import sys, fairlead.opencv, fairlead.detect; sys.exit('cv2' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
