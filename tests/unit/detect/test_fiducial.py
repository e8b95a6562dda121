# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What a detector reports, under which names, and what it refuses."""

import cv2
import numpy as np
import pytest

from fairlead.detect import Detector, detector_from_spec
from fairlead.types import Target

FAMILY = cv2.aruco.DICT_4X4_100


def target_with(*landmarks: str) -> Target:
    n = len(landmarks)
    return Target(name="t", landmarks=landmarks, positions=np.eye(n, 3), covariance=np.zeros((3 * n, 3 * n)))


def wall_of_tags(*tags: tuple[int, int, int], size: int = 240) -> np.ndarray:
    """Tags of 60 px (10 px a cell) on white: (identity, left, top)."""
    image = np.full((size, 2 * size), 255, np.uint8)
    for identity, left, top in tags:
        tag = cv2.aruco.generateImageMarker(cv2.aruco.getPredefinedDictionary(FAMILY), identity, 60)
        image[top : top + 60, left : left + 60] = tag
    return np.repeat(image[:, :, None], 3, axis=2)


def test_a_tag_has_its_corners_in_order_at_the_border_of_black() -> None:
    view = detector_from_spec("aruco:DICT_4X4_100").detect(wall_of_tags((17, 50, 70)), frame=3, stamp_ns=5)
    assert (view.frame, view.stamp_ns) == (3, 5)
    assert view.landmarks == ("tag17_tl", "tag17_tr", "tag17_br", "tag17_bl")
    # Pixels 50 to 109 are the tag's: its border lies half a pixel before and after.
    expected = [[49.5, 69.5], [109.5, 69.5], [109.5, 129.5], [49.5, 129.5]]
    np.testing.assert_allclose(view.pixels, expected, atol=0.02)
    assert (np.linalg.eigvalsh(view.covariances) > 0.0).all()


def test_a_turned_tag_keeps_its_names() -> None:
    detector = detector_from_spec("aruco:DICT_4X4_100")
    image = wall_of_tags((17, 50, 70))
    upright = detector.detect(image, 0, 0)
    turned = detector.detect(np.ascontiguousarray(np.rot90(image, 2)), 0, 0)
    height, width = image.shape[:2]
    assert turned.landmarks == upright.landmarks
    np.testing.assert_allclose(turned.pixels, [width - 1, height - 1] - upright.pixels, atol=0.02)


def test_only_the_target_is_reported() -> None:
    image = wall_of_tags((17, 50, 70), (5, 200, 70))
    view = detector_from_spec("aruco:DICT_4X4_100", target_with("tag5_tl", "tag5_br")).detect(image, 0, 0)
    assert view.landmarks == ("tag5_tl", "tag5_br")


def test_a_tag_that_is_there_twice_is_not_reported() -> None:
    view = detector_from_spec("aruco:DICT_4X4_100").detect(
        wall_of_tags((17, 50, 70), (17, 200, 70), (5, 350, 70)), 0, 0
    )
    assert {name.split("_")[0] for name in view.landmarks} == {"tag5"}


@pytest.mark.parametrize("spec", ["aruco:DICT_4X4_100", "apriltag:36h11", "charuco:7x5:DICT_4X4_50", "chessboard:8x5"])
@pytest.mark.parametrize("shape", [(1, 1), (3, 200), (240, 320)])
def test_nothing_to_see_is_an_empty_view(spec: str, shape: tuple[int, int]) -> None:
    detector = detector_from_spec(spec)
    assert isinstance(detector, Detector)
    for value in (0, 128, 255):
        view = detector.detect(np.full((*shape, 3), value, np.uint8), 0, 0)
        assert view.landmarks == ()
        assert view.pixels.shape == (0, 2)
        assert view.covariances.shape == (0, 2, 2)


def test_noise_is_no_tag(rng: np.random.Generator) -> None:
    image = rng.integers(0, 256, (240, 320, 3), dtype=np.uint8)
    assert detector_from_spec("aruco:DICT_4X4_100").detect(image, 0, 0).landmarks == ()


def test_a_tag_at_the_image_border_is_not_made_up() -> None:
    image = wall_of_tags((17, 50, 70))
    for cut in (48, 52, 55):
        view = detector_from_spec("aruco:DICT_4X4_100").detect(np.ascontiguousarray(image[:, cut:]), 0, 0)
        expected = np.array([[49.5, 69.5], [109.5, 69.5], [109.5, 129.5], [49.5, 129.5]]) - [cut, 0]
        assert view.landmarks == () or np.abs(view.pixels - expected).max() < 0.1


def test_apriltags_are_found_too() -> None:
    image = np.full((200, 200, 3), 255, np.uint8)
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    image[60:140, 40:120] = cv2.aruco.generateImageMarker(dictionary, 11, 80)[:, :, None]
    view = detector_from_spec("apriltag:36h11").detect(image, 0, 0)
    assert view.landmarks == tuple(f"tag11_{c}" for c in ("tl", "tr", "br", "bl"))
    np.testing.assert_allclose(view.pixels, [[39.5, 59.5], [119.5, 59.5], [119.5, 139.5], [39.5, 139.5]], atol=0.02)


def test_a_charuco_board_is_numbered_as_opencv_does() -> None:
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    board = cv2.aruco.CharucoBoard((7, 5), 1.0, 0.75, dictionary)
    grey = cv2.GaussianBlur(board.generateImage((700, 500)), (0, 0), 0.8)
    view = detector_from_spec("charuco:7x5:DICT_4X4_50:0.75").detect(np.repeat(grey[:, :, None], 3, axis=2), 0, 0)
    assert view.landmarks == tuple(f"corner{i}" for i in range(24))
    expected = [[100.0 * (i % 6 + 1) - 0.5, 100.0 * (i // 6 + 1) - 0.5] for i in range(24)]
    np.testing.assert_allclose(view.pixels, expected, atol=0.05)


@pytest.mark.parametrize("turns", [0, 1, 2, 3])
def test_a_chessboard_is_numbered_the_same_whichever_way_it_is_held(turns: int) -> None:
    squares = np.kron(np.indices((6, 9)).sum(axis=0) % 2, np.ones((30, 30))) * 255.0
    grey = cv2.GaussianBlur(np.pad(squares, 40, constant_values=255.0), (0, 0), 0.8).astype(np.uint8)
    held = np.ascontiguousarray(np.rot90(grey, turns))
    view = detector_from_spec("chessboard:8x5").detect(np.repeat(held[:, :, None], 3, axis=2), 0, 0)
    assert view.landmarks == tuple(f"corner{i}" for i in range(40))
    upright = np.array([[40 + 30 * (i % 8 + 1) - 0.5, 40 + 30 * (i // 8 + 1) - 0.5] for i in range(40)])
    height, width = grey.shape
    for _ in range(turns):  # a quarter turn to the left takes (x, y) to (y, width - 1 - x)
        upright = np.column_stack([upright[:, 1], width - 1 - upright[:, 0]])
        height, width = width, height
    np.testing.assert_allclose(view.pixels, upright, atol=0.05)


@pytest.mark.parametrize(
    "spec",
    [
        *("", "aruco", "aruco:", "aruco:DICT_9X9", "apriltag:36h99", "tag:3", "onnx:model.onnx", "chessboard:9"),
        *("chessboard:1x5", "chessboard:axb", "chessboard:999x9", "charuco:7x5", "charuco:7x5:DICT_4X4_50:1.5"),
        *("charuco:7x5:DICT_4X4_50:nan", "charuco:40x40:DICT_4X4_50"),
    ],
)
def test_a_bad_specification_says_what_was_expected(spec: str) -> None:
    with pytest.raises(ValueError, match=r"expected|unknown"):
        detector_from_spec(spec)


def test_a_target_that_the_detector_cannot_see_is_refused() -> None:
    with pytest.raises(ValueError, match="tag<id>_tl"):
        detector_from_spec("aruco:DICT_4X4_100", target_with("bow", "stern", "mast", "funnel"))


@pytest.mark.parametrize(
    "image", [np.zeros((20, 20, 4), np.uint8), np.zeros((20, 20, 3)), np.zeros((0, 20, 3), np.uint8)]
)
def test_another_kind_of_image_is_refused(image: np.ndarray) -> None:
    with pytest.raises((ValueError, TypeError)):
        detector_from_spec("aruco:DICT_4X4_100").detect(image, 0, 0)
