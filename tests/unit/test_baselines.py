# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The baselines solve what they can, and say why where they cannot."""

from dataclasses import replace

import numpy as np
import pytest

from fairlead.baselines.epnp import EpnpTracker
from fairlead.baselines.free_window import FreeWindowOptions, WindowTracker, free_batch
from fairlead.geometry import adjoint, difference, exp_se3, inverse, project, transform
from fairlead.types import Camera, Target, View

CAMERA = Camera(
    name="c",
    width=1280,
    height=960,
    model="plumb_bob",
    K=np.array([[900.0, 0.0, 640.0], [0.0, 910.0, 480.0], [0.0, 0.0, 1.0]]),
    distortion=np.array([-0.1, 0.05, 1e-3, -1e-3, 0.0]),
)
OPTIONS = FreeWindowOptions(window_size=4, min_turn_deg=2.0)


def target_of(positions: np.ndarray) -> Target:
    n = len(positions)
    names = tuple(f"p{i}" for i in range(n))
    return Target(name="t", landmarks=names, positions=positions, covariance=np.eye(3 * n))


def box(rng: np.random.Generator, n: int = 12) -> np.ndarray:
    return rng.uniform(-1.0, 1.0, (n, 3)) * [3.0, 1.0, 1.0] + [1.0, 2.0, 3.0]


def pose(turn_deg: float, distance: float = 12.0) -> np.ndarray:
    """Camera looking at (1, 2, 3), turned about the target's y axis."""
    T = exp_se3(np.array([0.0, 0.0, 0.0, 0.1, np.radians(turn_deg), -0.05]))
    T[:3, 3] = [0.2, -0.1, distance] - T[:3, :3] @ [1.0, 2.0, 3.0]
    return T


def view_of(target: Target, T: np.ndarray, frame: int = 0, noise: np.ndarray | float = 0.0) -> View:
    pixels = project(CAMERA, transform(T, target.positions)) + noise
    n = len(target.landmarks)
    covariances = np.tile(0.25 * np.eye(2), (n, 1, 1))
    return View(frame=frame, stamp_ns=frame, landmarks=target.landmarks, pixels=pixels, covariances=covariances)


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(4)


def test_epnp_finds_the_pose_of_an_exact_view(rng: np.random.Generator) -> None:
    target, T = target_of(box(rng)), pose(20.0)
    estimate = EpnpTracker(target, CAMERA).update(view_of(target, T))
    assert (estimate.status, estimate.reason) == ("tracking", "")
    # EPnP's own accuracy on exact data: float error times the condition of its 12 x 12 system.
    np.testing.assert_allclose(estimate.T_camera_target, T, atol=1e-4)
    assert estimate.reprojection_rms_px < 1e-2
    assert estimate.inliers == target.landmarks


@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_flat_landmarks_are_solved_too(rng: np.random.Generator, tilt: float) -> None:
    flat = box(rng)
    flat[:, 2] = 3.0 + tilt * flat[:, 0]
    target, T = target_of(flat), pose(25.0)
    estimate = EpnpTracker(target, CAMERA).update(view_of(target, T, noise=0.2 * rng.standard_normal((12, 2))))
    assert estimate.status == "tracking"
    assert estimate.reprojection_rms_px < 0.4


def test_the_covariance_is_that_of_least_squares(rng: np.random.Generator) -> None:
    # The window tracker's PnP minimises the reprojection error, so its scatter over noise is what eq. (1) says.
    target, T = target_of(box(rng, 20)), pose(20.0)
    batches = [
        free_batch([view_of(target, T, noise=0.5 * rng.standard_normal((20, 2)))], target, CAMERA) for _ in range(60)
    ]
    estimates = [batch.estimates[0] for batch in batches]
    nees = [(xi := difference(T, e.T_camera_target)) @ np.linalg.solve(e.covariance, xi) / 6.0 for e in estimates]
    assert 0.75 < np.mean(nees) < 1.3  # chi-square with 360 degrees of freedom: 1 +- 0.22 at 3 sigma


def test_a_target_may_have_its_origin_anywhere(rng: np.random.Generator) -> None:
    """The same pose of the landmarks, and the same covariance once both are written about the same point."""
    target, T = target_of(box(rng)), pose(20.0)
    to_far = np.eye(4)
    to_far[:3, 3] = [60_000.0, -80_000.0, 500.0]
    view = view_of(target, T, noise=0.3 * rng.standard_normal((12, 2)))
    far = replace(target, positions=transform(to_far, target.positions))
    near_by, from_afar = (EpnpTracker(each, CAMERA).update(view) for each in (target, far))
    back = inverse(to_far)
    np.testing.assert_allclose(from_afar.T_camera_target @ to_far, near_by.T_camera_target, atol=1e-6)
    covariance = adjoint(back) @ from_afar.covariance @ adjoint(back).T
    np.testing.assert_allclose(covariance, near_by.covariance, rtol=1e-3, atol=1e-9)
    assert free_batch([view], far, CAMERA).estimates[0].ok


def test_the_model_of_epnp_never_changes(rng: np.random.Generator) -> None:
    target = target_of(box(rng))
    tracker = EpnpTracker(target, CAMERA)
    tracker.update(view_of(target, pose(5.0)))
    assert tracker.model is target


def degenerate_views(target: Target) -> dict[str, View]:
    view = view_of(target, pose(10.0))
    z, S = view.pixels, view.covariances
    nan = z.copy()
    nan[2:] = np.nan
    return {
        "three landmarks": replace(view, landmarks=view.landmarks[:3], pixels=z[:3], covariances=S[:3]),
        "nothing": replace(view, landmarks=(), pixels=z[:0], covariances=S[:0]),
        "not finite": replace(view, pixels=nan),
        "no covariance": replace(view, covariances=0.0 * S),
        "infinite": replace(view, pixels=np.full_like(z, np.inf)),
        "one pixel": replace(view, pixels=np.tile(z[:1], (len(z), 1))),
        "one landmark": replace(view, landmarks=view.landmarks[:1] * len(z)),
        "beyond the lens": view_of(target, pose(10.0), 0, 1e6),
    }


@pytest.mark.parametrize("name", list(degenerate_views(target_of(box(np.random.default_rng(0))))))
@pytest.mark.parametrize("method", [EpnpTracker, WindowTracker])
def test_what_cannot_be_solved_has_a_reason(name: str, method: type, rng: np.random.Generator) -> None:
    target = target_of(box(rng))
    tracker = method(target, CAMERA)
    estimate = tracker.update(degenerate_views(target)[name])
    assert not estimate.ok
    assert estimate.reason in {"too_few", "degenerate"}
    assert np.isnan(estimate.T_camera_target).all()
    np.testing.assert_array_equal(tracker.model.positions, target.positions)


@pytest.mark.parametrize("positions", [np.outer(np.arange(8.0), [1.0, 2.0, 0.5]), np.tile([1.0, 2.0, 3.0], (8, 1))])
def test_landmarks_on_a_line_are_degenerate(positions: np.ndarray) -> None:
    target = target_of(positions)
    pixels = np.linspace([100.0, 100.0], [600.0, 300.0], 8)
    view = View(
        frame=0, stamp_ns=0, landmarks=target.landmarks, pixels=pixels, covariances=np.tile(np.eye(2), (8, 1, 1))
    )
    assert EpnpTracker(target, CAMERA).update(view).reason == "degenerate"


def test_an_unknown_landmark_is_the_callers_mistake(rng: np.random.Generator) -> None:
    target = target_of(box(rng))
    view = replace(view_of(target, pose(0.0)), landmarks=("q", *target.landmarks[1:]))
    for tracker in (EpnpTracker(target, CAMERA), WindowTracker(target, CAMERA)):
        with pytest.raises(ValueError, match="'q'"):
            tracker.update(view)


def test_three_landmarks_are_no_target() -> None:
    for method in (EpnpTracker, WindowTracker):
        with pytest.raises(ValueError, match="at least 4"):
            method(target_of(np.eye(3)), CAMERA)


def test_the_window_speaks_when_it_is_full(rng: np.random.Generator) -> None:
    target = target_of(box(rng))
    tracker = WindowTracker(target, CAMERA, OPTIONS)
    # Turns of 1.2 degrees: every second view is a keyframe, the fourth keyframe is view 6.
    statuses = [tracker.update(view_of(target, pose(1.2 * k), k)).status for k in range(9)]
    assert statuses == ["acquiring"] * 6 + ["tracking"] * 3


def test_the_window_improves_a_wrong_model(rng: np.random.Generator) -> None:
    truth = target_of(box(rng, 16))
    told = replace(truth, positions=truth.positions + 0.05 * rng.standard_normal((16, 3)))
    tracker = WindowTracker(told, CAMERA, OPTIONS)
    views = [view_of(truth, pose(8.0 * k), k, 0.1 * rng.standard_normal((16, 2))) for k in range(12)]
    for view in views:
        estimate = tracker.update(view)
    naive = EpnpTracker(told, CAMERA).update(views[-1])
    assert estimate.reprojection_rms_px < 0.5 * naive.reprojection_rms_px
    assert np.linalg.norm(tracker.model.positions - truth.positions) < np.linalg.norm(told.positions - truth.positions)


def test_a_landmark_seen_once_stays_where_it_is(rng: np.random.Generator) -> None:
    target = target_of(box(rng))
    views = [view_of(target, pose(8.0 * k), k, 0.3 * rng.standard_normal((12, 2))) for k in range(5)]
    seen = views[0]
    views[1:] = [
        replace(v, landmarks=v.landmarks[1:], pixels=v.pixels[1:], covariances=v.covariances[1:]) for v in views[1:]
    ]
    found = free_batch([seen, *views[1:]], target, CAMERA)
    np.testing.assert_array_equal(found.model.positions[0], target.positions[0])
    assert (found.model.positions[1:] != target.positions[1:]).all()


def test_a_batch_goes_on_without_the_views_that_fail(rng: np.random.Generator) -> None:
    target = target_of(box(rng))
    bad = degenerate_views(target)["three landmarks"]
    views = [view_of(target, pose(8.0 * k), k) for k in range(4)]
    found = free_batch([views[0], bad, *views[1:]], target, CAMERA)
    assert [e.reason for e in found.estimates] == ["", "too_few", "", "", ""]
    assert free_batch([], target, CAMERA).estimates == ()


@pytest.mark.parametrize(
    "change",
    [{"window_size": 1}, {"iterations": 0}, {"min_turn_deg": -1.0}, {"min_range_ratio": 0.5}, {"initial_damping": 0.0}],
)
def test_impossible_options_are_refused(change: dict) -> None:
    with pytest.raises(ValueError, match="window: expected"):
        FreeWindowOptions(**change)
