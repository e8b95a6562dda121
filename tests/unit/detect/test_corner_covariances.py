# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The covariance of a corner is true: errors against drawings whose corners are known."""

import numpy as np
import pytest

from fairlead import opencv
from fairlead.detect import detector_from_spec
from fairlead.detect.fiducial import CORNERS
from fairlead.types import View

TAGS = 20
BOARDS = 4

# Mean of e^T S^-1 e / 2. White errors would leave 1 +- 0.33 with 20 tags (3 sigma of 160 values); the band allows for
# sigmas up to 2 times too wide (images with next to no noise, where the floor rules) and 1.25 times too narrow.
NEES_BAND = (0.2, 1.9)


def errors_of(views: list[View], truths: list[dict[str, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    e = []
    for view, truth in zip(views, truths, strict=True):
        e += [z - truth[name] for name, z in zip(view.landmarks, view.pixels, strict=True)]
    return np.array(e), np.concatenate([view.covariances for view in views])


def nees(e: np.ndarray, S: np.ndarray) -> float:
    return float(np.mean(np.einsum("ni,nij,nj->n", e, np.linalg.inv(S), e)) / 2.0)


def rms(e: np.ndarray) -> float:
    return float(np.sqrt((e**2).sum(axis=1).mean()))


def colour(grey: np.ndarray) -> np.ndarray:
    return np.repeat(grey[:, :, None], 3, axis=2)


# Limits on the error: twice what was measured when the covariances were set up, docs/fiducials.md section 5.
@pytest.mark.parametrize(
    ("side_px", "optics", "limit_px"),
    [
        (60, {}, 0.06),
        (60, {"noise": 6.0}, 0.1),
        (60, {"noise": 0.0, "blur_px": 0.5}, 0.08),
        (25, {}, 0.3),
        (60, {"gamma": 2.2}, 0.07),
        (60, {"blur_px": 1.5}, 0.1),
        (60, {"motion_px": (3.0, 2.0)}, 0.08),
        (60, {"gamma": 2.2, "blur_px": 1.2, "motion_px": (-2.0, 3.5)}, 0.3),
    ],
)
def test_tag_corners_err_as_they_say(studio, rng, side_px: float, optics: dict, limit_px: float) -> None:
    detector = detector_from_spec("aruco:DICT_4X4_100")
    views, truths = [], []
    for identity in rng.integers(0, 100, TAGS):
        drawing = studio.tag(rng, int(identity), side_px=side_px, optics=studio.optics(**optics))
        views.append(detector.detect(colour(drawing.image), 0, 0))
        truths.append({f"tag{identity}_{c}": z for c, z in zip(CORNERS, drawing.corners, strict=True)})
    assert sum(len(view.landmarks) for view in views) >= 0.9 * 4 * TAGS
    e, S = errors_of(views, truths)
    assert rms(e) <= limit_px
    found = nees(e, S)
    assert NEES_BAND[0] <= found <= NEES_BAND[1]


@pytest.mark.parametrize(
    ("optics", "limit_px"),
    [({}, 0.03), ({"noise": 6.0}, 0.07), ({"gamma": 2.2}, 0.03), ({"blur_px": 1.5, "gamma": 2.2}, 0.06)],
)
def test_board_corners_err_as_they_say(studio, rng, optics: dict, limit_px: float) -> None:
    detector = detector_from_spec("chessboard:8x5")
    views, truths = [], []
    for _ in range(BOARDS):
        drawing = studio.board(rng, columns=9, rows=6, side_px=190, optics=studio.optics(**optics))
        views.append(detector.detect(colour(drawing.image), 0, 0))
        truths.append({f"corner{i}": z for i, z in enumerate(drawing.corners)})
    assert sum(len(view.landmarks) for view in views) >= 0.6 * 40 * BOARDS
    e, S = errors_of(views, truths)
    assert rms(e) <= limit_px
    found = nees(e, S)
    assert NEES_BAND[0] <= found <= NEES_BAND[1]


def test_the_tone_curve_does_not_move_the_corners(studio, rng) -> None:
    # Drawn twice from the same state: linear, and as sRGB cameras have it. OpenCV's own refinement moves by 0.35 px.
    detector = detector_from_spec("aruco:DICT_4X4_100")
    moved = []
    for identity in range(6):
        state = rng.bit_generator.state
        pair = []
        for gamma in (1.0, 2.2):
            rng.bit_generator.state = state
            drawing = studio.tag(rng, identity, side_px=70, optics=studio.optics(gamma=gamma, noise=1.0))
            pair.append(detector.detect(colour(drawing.image), 0, 0).pixels)
        moved.append(pair[0] - pair[1])
    assert rms(np.concatenate(moved)) < 0.06


def test_a_finger_over_one_edge_is_left_out(studio, rng) -> None:
    detector = detector_from_spec("aruco:DICT_4X4_100")
    drawing = studio.tag(rng, 7, side_px=90, optics=studio.optics(), tilt=0.1)
    free = detector.detect(colour(drawing.image), 0, 0)
    covered = drawing.image.copy()
    middle = np.rint(0.35 * drawing.corners[0] + 0.65 * drawing.corners[1]).astype(int)
    covered[middle[1] - 5 : middle[1] + 5, middle[0] - 5 : middle[0] + 5] = 120
    seen = detector.detect(colour(covered), 0, 0)
    assert seen.landmarks == free.landmarks
    assert rms(seen.pixels - drawing.corners) < 0.15


def test_the_inner_cells_are_where_opencv_prints_them() -> None:
    # Black border all round, so that the spread is measured on the cells inside.
    for family in ("DICT_4X4_100", "DICT_APRILTAG_36h11"):
        pattern = opencv.marker_image(family, 3, 1) > 0
        assert pattern.shape == (opencv.marker_cells(family),) * 2
        assert not pattern[[0, -1]].any()
        assert not pattern[:, [0, -1]].any()
