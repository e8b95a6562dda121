# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""From whole images to views: acquiring, following, losing, acquiring again; a network that really looks."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fairlead import geometry, opencv
from fairlead.detect import detector_from_spec
from fairlead.detect.network import NetworkDetector
from fairlead.io.errors import InputError
from fairlead.io.network_card import Calibration, NetworkCard, NetworkInput
from fairlead.opencv.filters import write_image
from fairlead.tracker import Tracker
from fairlead.types import Matrix4, Target, View
from tests.unit.detect.networks import COLOURS, NAMES, heat_network, heatmap_network, saved, simcc_network
from tests.unit.detect.spots import draw, seen_from, spot, spots_target, wide_camera
from tests.unit.detect.test_onnx_session import HEATMAP, SIMCC

STEP_NS = 40_000_000
CARD = NetworkCard(
    name="spots",
    landmarks=NAMES,
    input=NetworkInput(name="image", width=256, height=256, std=(255.0, 255.0, 255.0), any_size=True),
    calibration=Calibration(visible_threshold=0.0),
)


def heat(folder: Path) -> Path:
    return saved(heat_network(CARD), folder / "heat.onnx")


def simcc(folder: Path) -> Path:
    path = saved(simcc_network((192, 256)), folder / "simcc.onnx")
    path.with_suffix(".toml").write_text(SIMCC + "visible_threshold = 1.0\n[acquisition]\nvisible_threshold = 1.0\n")
    return path


def heatmap(folder: Path) -> Path:
    path = saved(heatmap_network((192, 256)), folder / "heatmap.onnx")
    path.with_suffix(".toml").write_text(HEATMAP + "visible_threshold = 0.2\n[acquisition]\nvisible_threshold = 0.2\n")
    return path


def worst(view: View, truth: np.ndarray) -> float:
    """Largest error [px]."""
    return float(np.abs(view.pixels - truth[[NAMES.index(name) for name in view.landmarks]]).max())


@pytest.mark.parametrize("make", [heat, simcc, heatmap])
@pytest.mark.parametrize(("depth_m", "aside_m"), [(60.0, (14.0, -9.0)), (110.0, (-30.0, 22.0)), (28.0, (0.0, 0.0))])
def test_it_is_found_anywhere_through_a_lens(
    tmp_path: Path, make: Callable[[Path], Path], depth_m: float, aside_m: tuple[float, float]
) -> None:
    camera = wide_camera()
    picture = draw(camera, seen_from(depth_m, aside_m=aside_m))
    detector = NetworkDetector(make(tmp_path), spots_target(), camera)
    view = detector.detect(picture.image, 4, 17)
    assert (view.frame, view.stamp_ns, len(view.landmarks)) == (4, 17, len(NAMES))
    assert worst(view, picture.pixels) < 0.3  # half a pixel of the image, or of a crop of 256, is more


def test_a_grey_image_is_looked_at_as_a_grey_file_is(tmp_path: Path) -> None:
    camera = wide_camera()
    grey = opencv.grey(draw(camera, seen_from(60.0)).image)
    write_image(tmp_path / "grey.png", grey)
    read = opencv.read_image(tmp_path / "grey.png")
    path = heat(tmp_path)
    views = [NetworkDetector(path, spots_target(), camera).detect(image, 0, 0) for image in (grey, read)]
    assert views[0].landmarks == views[1].landmarks
    np.testing.assert_array_equal(views[0].pixels, views[1].pixels)
    np.testing.assert_array_equal(opencv.coloured(grey), read)
    with pytest.raises(ValueError, match=r"image: expected 8 bits, \(h, w\) or \(h, w, 3\), got float64"):
        opencv.coloured(np.zeros((4, 4)))


def test_following_looks_once_and_finds_what_acquiring_finds(tmp_path: Path) -> None:
    camera = wide_camera()
    detector = NetworkDetector(heat(tmp_path), spots_target(), camera)
    counting = Counting(detector)
    for k in range(20):
        picture = draw(camera, seen_from(60.0 - k, aside_m=(0.4 * k, -0.2 * k), turn_rad=0.3 + 0.01 * k))
        view = detector.detect(picture.image, k, k * STEP_NS)
        assert len(view.landmarks) == len(NAMES)
        assert worst(view, picture.pixels) < 0.2
    assert detector.acquisitions == 1
    assert counting.looks[1:] == [1] * 19


class Counting:
    """How many crops the network is shown for each image."""

    def __init__(self, detector: NetworkDetector) -> None:
        self.looks: list[int] = []
        network, detect = detector.network, detector.detect
        look = network.look

        def counted(crop: np.ndarray) -> object:
            self.looks[-1] += 1
            return look(crop)

        def started(*arguments: object) -> View:
            self.looks.append(0)
            return detect(*arguments)  # pyright: ignore[reportArgumentType]

        network.look = counted  # pyright: ignore[reportAttributeAccessIssue]
        detector.detect = started  # pyright: ignore[reportAttributeAccessIssue]


def flight(k: int) -> Matrix4:
    return seen_from(60.0 - 0.2 * k, aside_m=(0.1 * k, 0.0), turn_rad=0.3 + 0.005 * k)


def test_covered_for_three_seconds_it_is_found_again(tmp_path: Path) -> None:
    camera = wide_camera(320, 240)
    detector, tracker = NetworkDetector(heat(tmp_path), spots_target(), camera), Tracker(spots_target(), camera)
    states: list[str] = []
    for k in range(24):
        covered = 6 <= k < 18
        picture = draw(camera, seen_from(30.0 - 0.2 * k), hidden=frozenset(NAMES) if covered else frozenset())
        view = detector.detect(picture.image, k, 250_000_000 * k)
        assert (len(view.landmarks) == 0) == covered
        estimate = tracker.update(view)
        detector.follow(estimate)
        states.append(estimate.status)
    assert states[5] == "tracking"
    assert set(states[10:18]) <= {"lost", "acquiring"}
    assert states[21:] == ["tracking"] * 3


def test_a_jump_is_noticed_in_the_same_image(tmp_path: Path) -> None:
    camera = wide_camera()
    detector = NetworkDetector(heat(tmp_path), spots_target(), camera)
    for k, aside in enumerate([(0.0, 0.0)] * 5 + [(20.0, -12.0)] * 5):
        picture = draw(camera, seen_from(60.0, aside_m=aside))
        view = detector.detect(picture.image, k, k * STEP_NS)
        assert worst(view, picture.pixels) < 0.2
        assert len(view.landmarks) == len(NAMES)
    assert detector.acquisitions == 2


def test_three_landmarks_where_they_were_predicted_are_reported(tmp_path: Path) -> None:
    camera = wide_camera()
    detector, tracker = NetworkDetector(heat(tmp_path), spots_target(), camera), Tracker(spots_target(), camera)
    for k in range(20):
        hidden = frozenset(NAMES[3:]) if k >= 12 else frozenset()
        picture = draw(camera, flight(k), hidden=hidden)
        view = detector.detect(picture.image, k, k * STEP_NS)
        detector.follow(tracker.update(view))
        assert len(view.landmarks) == (3 if k >= 12 else len(NAMES))
    assert detector.acquisitions == 1


def test_the_estimators_pose_leads(tmp_path: Path) -> None:
    """A detector that was told where the target is looks there, and not in the whole image."""
    camera = wide_camera()
    detector, tracker = NetworkDetector(heat(tmp_path), spots_target(), camera), Tracker(spots_target(), camera)
    picture = draw(camera, flight(0))
    other = NetworkDetector(heat(tmp_path), spots_target(), camera)
    detector.follow(tracker.update(other.detect(picture.image, 0, 0)))
    assert len(detector.detect(draw(camera, flight(1)).image, 1, STEP_NS).landmarks) == len(NAMES)
    assert detector.acquisitions == 0


def test_where_there_is_no_target_nothing_is_found(tmp_path: Path) -> None:
    camera = wide_camera(320, 240)
    detector = NetworkDetector(heat(tmp_path), spots_target(), camera)
    rng = np.random.default_rng(6)
    false = 0
    for k in range(12):
        light = np.full((camera.height, camera.width, 3), 12.0)
        if k % 3:  # the landmarks of something else, laid out otherwise
            for colour in COLOURS:
                spot(light, rng.uniform(30.0, 210.0, 2), rng.uniform(3.0, 9.0), colour)
        if k % 3 == 2:
            light += rng.normal(0.0, 20.0, light.shape)
        image = np.clip(light, 0, 255).astype(np.uint8)
        false += len(detector.detect(image, k, k * STEP_NS).landmarks) > 0
    assert false == 0


def test_the_target_with_its_landmarks_mixed_up_is_another(tmp_path: Path) -> None:
    camera = wide_camera()
    target = spots_target()
    mixed = replace(target, positions=target.positions[[3, 0, 5, 1, 6, 2, 4]])
    picture = draw(camera, seen_from(50.0))
    assert len(NetworkDetector(heat(tmp_path), target, camera).detect(picture.image, 0, 0).landmarks) == len(NAMES)
    assert NetworkDetector(heat(tmp_path), mixed, camera).detect(picture.image, 0, 0).landmarks == ()


def test_the_pose_from_detected_pixels_is_the_true_one(tmp_path: Path) -> None:
    camera = wide_camera()
    detector, tracker = (
        NetworkDetector(heat(tmp_path), spots_target(0.001), camera),
        Tracker(spots_target(0.001), camera),
    )
    for k in range(10):
        T = flight(k)
        estimate = tracker.update(detector.detect(draw(camera, T).image, k, k * STEP_NS))
        detector.follow(estimate)
        assert estimate.ok
        xi = geometry.difference(T, estimate.T_camera_target)
        assert np.linalg.norm(xi[3:]) < 0.01
        assert np.linalg.norm(xi[:3]) < 0.01 * T[2, 3]


def test_a_large_image_and_a_small_one(tmp_path: Path) -> None:
    for width, height, depth in ((3840, 2160, 60.0), (200, 150, 20.0)):
        camera = wide_camera(width, height)
        K = camera.K.copy()
        K[0, 0] = K[1, 1] = 1.1 * width
        camera = replace(camera, K=K)
        picture = draw(camera, seen_from(depth, aside_m=(2.0, 1.0)))
        view = NetworkDetector(heat(tmp_path), spots_target(), camera).detect(picture.image, 0, 0)
        assert len(view.landmarks) == len(NAMES)
        assert worst(view, picture.pixels) < 0.3 * max(1.0, width / 1024)


def test_only_landmarks_of_the_target_are_reported(tmp_path: Path) -> None:
    camera, target = wide_camera(), spots_target()
    keep = [0, 1, 2, 4, 6]
    rows = np.concatenate([np.arange(3 * j, 3 * j + 3) for j in keep])
    part = Target(
        name="part",
        landmarks=tuple(NAMES[j] for j in keep),
        positions=target.positions[keep],
        covariance=target.covariance[np.ix_(rows, rows)],
    )
    view = NetworkDetector(heat(tmp_path), part, camera).detect(draw(camera, seen_from(60.0)).image, 0, 0)
    assert view.landmarks == part.landmarks
    few = replace(part, landmarks=("red", "green", "blue", "other", "another"))
    with pytest.raises(InputError, match=r"expected the landmarks of target part \(red, green, blue, other"):
        NetworkDetector(heat(tmp_path), few, camera)


def test_a_specification_that_ends_in_onnx_is_a_network(tmp_path: Path) -> None:
    assert isinstance(detector_from_spec(str(heat(tmp_path)), spots_target(), wide_camera()), NetworkDetector)
    with pytest.raises(ValueError, match="expected a target and a camera"):
        detector_from_spec(str(heat(tmp_path)))
    with pytest.raises(ValueError, match="expected one of"):
        detector_from_spec("no-such-ship", spots_target(), wide_camera())
