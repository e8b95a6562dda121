# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Marks carried from frame to frame: flow on images whose motion is known."""

import numpy as np
import pytest

from fairlead.annotate.labels import Labels, Mark
from fairlead.annotate.propagate import FLOW_SIGMA_PX, carry_marks, expected_shifts, without_outliers
from fairlead.annotate.solve import solve_frame, view_of
from fairlead.opencv import carry_points
from tests.unit.annotate.conftest import Scene


def texture(du: float, dv: float) -> np.ndarray:
    """Blobs, moved by (du, dv) px."""
    rng = np.random.default_rng(5)
    v, u = np.mgrid[0:240, 0:320].astype(np.float64)
    image = np.full((240, 320), 90.0)
    for cu, cv, height, width in rng.uniform((0, 0, -70, 2.5), (320, 240, 70, 5.0), (400, 4)):
        image += height * np.exp(-((u - du - cu) ** 2 + (v - dv - cv) ** 2) / (2.0 * width**2))
    return np.clip(image, 0, 255).astype(np.uint8)


PIXELS = np.array([(u, v) for u in (60.0, 160.0, 250.0) for v in (60.0, 120.0, 190.0)])


def test_flow_finds_a_subpixel_shift() -> None:
    carried, followed = carry_points(texture(0.0, 0.0), texture(3.3, -2.6), PIXELS, PIXELS)
    assert followed.all()
    np.testing.assert_allclose(carried - PIXELS, np.tile([3.3, -2.6], (9, 1)), atol=0.1)


def test_a_guess_lets_flow_follow_a_large_jump() -> None:
    before, after = texture(0.0, 0.0), texture(70.0, 12.0)
    near = PIXELS[PIXELS[:, 0] < 200.0]
    _, lost = carry_points(before, after, near, near)
    carried, followed = carry_points(before, after, near, near + np.array([66.0, 10.0]))
    assert followed.sum() > lost.sum()
    np.testing.assert_allclose((carried - near)[followed], np.tile([70.0, 12.0], (followed.sum(), 1)), atol=0.15)


def test_what_left_the_image_is_lost_and_sizes_must_agree() -> None:
    edge = np.array([[310.0, 100.0]])
    _, followed = carry_points(texture(0.0, 0.0), texture(20.0, 0.0), edge, edge + np.array([20.0, 0.0]))
    assert not followed.any()
    with pytest.raises(ValueError, match="images of one size"):
        carry_points(texture(0, 0), texture(0, 0)[:100], edge, edge)
    nothing, none = carry_points(texture(0, 0), texture(0, 0), np.empty((0, 2)), np.empty((0, 2)))
    assert nothing.shape == (0, 2)
    assert none.shape == (0,)


def test_clicks_stay_and_the_rest_is_carried() -> None:
    marks = {
        0: Mark(u_px=60.0, v_px=60.0),
        1: Mark(u_px=160.0, v_px=120.0),
        2: Mark(hidden=True),
        3: Mark(u_px=250.0, v_px=190.0),
    }
    present = {0: Mark(u_px=1.0, v_px=1.0), 1: Mark(u_px=5.0, v_px=5.0, origin="flow"), 3: Mark(hidden=True)}
    carried = carry_marks(marks, present, texture(0.0, 0.0), texture(2.0, 1.0))
    assert carried[0] == present[0]
    assert carried[3] == present[3]
    assert carried[2].hidden
    assert carried[1].origin == "flow"
    assert carried[1].sigma_px == FLOW_SIGMA_PX
    assert (carried[1].u_px, carried[1].v_px) == pytest.approx((162.0, 121.0), abs=0.1)


def test_a_carried_mark_that_slid_away_is_taken_out_and_a_click_is_not(scene: Scene) -> None:
    labels = scene.labels(np.random.default_rng(1))
    marks = dict(labels.frames[2])
    slid, clicked = next(iter(marks)), list(marks)[3]
    for number, origin in ((slid, "flow"), (clicked, "click")):
        mark = marks[number]
        marks[number] = Mark(u_px=mark.u_px + 40.0, v_px=mark.v_px, origin=origin)  # pyright: ignore[reportArgumentType]
    left, solved = without_outliers(labels, 2, marks, scene.camera, scene.surface)
    assert set(left) == set(marks) - {slid}
    assert solved is not None
    assert [each.number for each in solved.warnings] == [clicked]
    few = dict(list(marks.items())[:2])
    assert without_outliers(labels, 2, few, scene.camera, None) == (few, None)


def test_the_next_shift_is_the_last_one(scene: Scene) -> None:
    labels = scene.labels(np.random.default_rng(1), noise_px=0.0)
    a, b = (solve_frame(labels, view_of(labels, frame, 0), scene.camera) for frame in (0, 1))
    shifts = expected_shifts(a, b)
    pixels = scene.pixels()
    assert len(shifts) == 18
    np.testing.assert_allclose(np.array([shifts[n] for n in range(18)]), pixels[1] - pixels[0], atol=1e-3)
    assert expected_shifts(None, b) == {}
    nothing = Labels(landmarks=labels.landmarks)
    assert expected_shifts(solve_frame(nothing, view_of(nothing, 0, 0), scene.camera), b) == {}
