# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Records refuse what they cannot hold, copy their arrays and set them read-only."""

from collections.abc import Iterator
from typing import Any

import jaxtyping
import numpy as np
import pytest

from fairlead.types import Camera, Estimate, KnownDistance, MotionPrior, Target, TruthPose, View, is_covariance

NAN = float("nan")


@pytest.fixture(autouse=True)
def as_in_production() -> Iterator[None]:
    """Annotations are checked in tests only; here it is asked what the records check by themselves."""
    jaxtyping.config.update("jaxtyping_disable", True)
    yield
    jaxtyping.config.update("jaxtyping_disable", False)


def camera(**changes: Any) -> Camera:
    values: dict[str, Any] = {
        "name": "c",
        "width": 640,
        "height": 480,
        "model": "plumb_bob",
        "K": np.array([[500.0, 0.0, 320.0], [0.0, 510.0, 240.0], [0.0, 0.0, 1.0]]),
        "distortion": np.zeros(5),
    }
    return Camera(**(values | changes))


def target(**changes: Any) -> Target:
    values: dict[str, Any] = {
        "name": "t",
        "landmarks": ("a", "b"),
        "positions": np.array([[0.0, 0.0, 0.0], [1.0, 2.0, 3.0]]),
        "covariance": np.eye(6),
    }
    return Target(**(values | changes))


def estimate(**changes: Any) -> Estimate:
    values: dict[str, Any] = {
        "frame": 0,
        "stamp_ns": 1,
        "status": "tracking",
        "reason": "",
        "T_camera_target": np.eye(4),
        "covariance": np.eye(6),
        "n_inliers": 4,
        "reprojection_rms_px": 0.5,
        "information_gained": 0.1,
        "reset_counter": 0,
        "inliers": ("a",),
    }
    return Estimate(**(values | changes))


def skewed() -> np.ndarray:
    return np.array([[500.0, 1.0, 320.0], [0.0, 500.0, 240.0], [0.0, 0.0, 1.0]])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"width": 0}, "positive width and height"),
        ({"height": -1}, "positive width and height"),
        ({"width": 2**70}, "64-bit"),
        ({"width": 640.5}, "expected an integer"),
        ({"model": "mirror"}, "expected one of pinhole"),
        ({"K": np.eye(2)}, r"expected shape \(3, 3\), got \(2, 2\)"),
        ({"K": np.full((3, 3), NAN)}, "finite"),
        ({"K": skewed()}, "fx, 0, cx"),
        ({"K": np.diag([-1.0, 1.0, 1.0])}, "positive focal lengths"),
        ({"distortion": np.zeros(4)}, r"distortion of plumb_bob: expected shape \(5,\)"),
        ({"distortion": np.full(5, np.inf)}, "finite"),
        ({"distortion": "wide"}, "expected numbers"),
    ],
)
def test_an_unusable_camera_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        camera(**changes)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"landmarks": ("a", "a")}, "'a' more than once"),
        ({"landmarks": ("a", "")}, "non-empty"),
        ({"positions": np.zeros((3, 3))}, r"expected shape \(2, 3\)"),
        ({"positions": np.full((2, 3), np.inf)}, "finite"),
        ({"covariance": -np.eye(6)}, "positive semidefinite"),
        ({"covariance": np.triu(np.ones((6, 6)))}, "symmetric"),
        ({"covariance": np.eye(3)}, r"expected shape \(6, 6\)"),
        ({"touchdown": np.zeros(2)}, "touchdown"),
        ({"touchdown": np.full(3, NAN)}, "touchdown"),
        ({"distances": (KnownDistance(between=("a", "z"), length_m=1.0, sigma_m=0.1),)}, "no landmark is named 'z'"),
    ],
)
def test_an_unusable_target_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        target(**changes)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"status": "asleep"}, "expected one of acquiring"),
        ({"T_camera_target": np.full((4, 4), NAN)}, "rigid"),
        ({"T_camera_target": np.diag([1.0, 1.0, -1.0, 1.0])}, "rigid"),
        ({"covariance": -np.eye(6)}, "positive semidefinite"),
        ({"covariance": np.full((6, 6), NAN)}, "positive semidefinite"),
        ({"status": "lost"}, "expected NaN pose"),
        ({"status": "acquiring", "T_camera_target": np.full((4, 4), NAN)}, "expected NaN pose"),
        ({"stamp_ns": 1.5}, "stamp_ns: expected an integer"),
    ],
)
def test_an_estimate_that_says_one_thing_and_holds_another_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        estimate(**changes)


def test_only_tracking_and_coasting_are_ok() -> None:
    nothing = {"T_camera_target": np.full((4, 4), NAN), "covariance": np.full((6, 6), NAN)}
    assert estimate().ok
    assert estimate(status="coasting").ok
    assert not estimate(status="lost", **nothing).ok
    assert not estimate(status="acquiring", **nothing).ok


def test_a_view_may_hold_numbers_that_are_not_finite_and_landmarks_twice() -> None:
    view = View(
        frame=0,
        stamp_ns=-5,
        landmarks=("a", "a"),
        pixels=np.full((2, 2), NAN),
        covariances=np.full((2, 2, 2), np.inf),
    )
    assert view.landmarks == ("a", "a")
    with pytest.raises(ValueError, match=r"view pixels: expected shape \(1, 2\), got \(2, 2\)"):
        View(frame=0, stamp_ns=0, landmarks=("a",), pixels=np.zeros((2, 2)), covariances=np.zeros((1, 2, 2)))
    with pytest.raises(ValueError, match="view scores"):
        View(
            frame=0,
            stamp_ns=0,
            landmarks=("a",),
            pixels=np.zeros((1, 2)),
            covariances=np.zeros((1, 2, 2)),
            scores=np.zeros(2),
        )


def test_a_view_of_nothing_takes_empty_lists() -> None:
    view = View(frame=0, stamp_ns=0, landmarks=(), pixels=[], covariances=[])
    assert view.pixels.shape == (0, 2)
    assert view.covariances.shape == (0, 2, 2)
    with pytest.raises(ValueError, match=r"view pixels: expected shape \(1, 2\), got \(0,\)"):
        View(frame=0, stamp_ns=0, landmarks=("a",), pixels=[], covariances=[])


@pytest.mark.parametrize(
    ("pixels", "came"),
    [
        (np.ma.array([[1.0, 2.0]], mask=[[False, True]]), "MaskedArray"),
        (np.array([[1.0, 2.0j]]), "complex numbers"),
        ([[1.0, 2.0j]], "complex numbers"),
        ([[1.0, 2.0], [3.0]], "list"),
        ([["left", "right"]], "list"),
    ],
)
def test_an_array_is_not_made_by_leaving_something_out(pixels: Any, came: str) -> None:
    with pytest.raises(ValueError, match=rf"view pixels: expected numbers of shape \(1, 2\), got {came}$"):
        View(frame=0, stamp_ns=0, landmarks=("a",), pixels=pixels, covariances=np.zeros((1, 2, 2)))


def test_arrays_are_copied_and_read_only() -> None:
    positions = np.zeros((2, 3))
    record = target(positions=positions)
    positions[0, 0] = 7.0
    assert record.positions[0, 0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        record.positions[0, 0] = 1.0
    assert record.positions.dtype == np.float64


def test_distances_and_motion_are_checked() -> None:
    with pytest.raises(ValueError, match="two different landmarks"):
        KnownDistance(between=("a", "a"), length_m=1.0, sigma_m=0.1)
    with pytest.raises(ValueError, match="length_m"):
        KnownDistance(between=("a", "b"), length_m=-1.0, sigma_m=0.1)
    with pytest.raises(ValueError, match="sigma_m"):
        KnownDistance(between=("a", "b"), length_m=1.0, sigma_m=0.0)
    with pytest.raises(ValueError, match="jerk_density"):
        MotionPrior(kind="range", jerk_density_m_s25=-1.0)
    with pytest.raises(ValueError, match="rigid"):
        TruthPose(frame=0, stamp_ns=0, T_camera_target=2.0 * np.eye(4))


def test_covariance_check_sees_small_blocks_beside_large_ones() -> None:
    mixed = np.diag([1e6, 1e6, 1e6, 1e-6, 1e-6, 1e-6])
    assert is_covariance(mixed)
    mixed[3, 4] = mixed[4, 3] = 2e-6  # correlation 2: not a covariance, though tiny beside 1e6
    assert not is_covariance(mixed)
    assert is_covariance(np.zeros((3, 3)))
    assert not is_covariance(np.array([[0.0, 1.0], [1.0, 0.0]]))
    direction = np.array([[1.0], [2.0], [3.0]])
    assert is_covariance(direction @ direction.T)
