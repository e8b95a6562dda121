# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Clips give back the stamps exactly, and the colours to every reader alike."""

from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np
import pytest

from fairlead.video.clip import ClipWriter, video_stamps, yuv420

COLOURS = [
    (255, 0, 0),
    (0, 255, 0),
    (0, 0, 255),
    (255, 255, 255),
    (0, 0, 0),
    (128, 128, 128),
    (30, 200, 240),
    (9, 60, 5),
]
"""Blue, green, red."""
SECOND_NS = 1_000_000_000


def patches(shift: int = 0) -> np.ndarray:
    """Squares of 32 px in two rows of four."""
    image = np.zeros((64, 128, 3), np.uint8)
    for k, colour in enumerate(COLOURS):
        row, column = divmod((k + shift) % len(COLOURS), 4)
        image[32 * row : 32 * row + 32, 32 * column : 32 * column + 32] = colour
    return image


def middles(image: np.ndarray) -> np.ndarray:
    """The middle of each square, where no neighbour's colour difference reaches."""
    return np.array([[image[32 * r + 16, 32 * c + 16] for c in range(4)] for r in range(2)]).astype(int)


def write(path: Path, stamps: list[int], crf: float = 1.0) -> Path:
    with ClipWriter(path, 128, 64, rate_hz=Fraction(25, 6), crf=crf) as writer:
        for k, stamp in enumerate(stamps):
            writer.write(patches(k), stamp)
    return path


def decoded_by_av(path: Path) -> list[tuple[int, np.ndarray]]:
    with av.open(str(path)) as container:
        return [
            (round(frame.pts * frame.time_base * SECOND_NS), frame.to_ndarray(format="bgr24"))
            for frame in container.decode(video=0)
        ]


def decoded_by_opencv(path: Path) -> list[np.ndarray]:
    video = cv2.VideoCapture(str(path))
    found = []
    while (read := video.read())[0]:
        found.append(read[1])
    return found


def test_stamps_are_exact_from_the_first_on(tmp_path: Path) -> None:
    stamps = [33_040_000_000 + 240_000_000 * k for k in range(9)]
    stamps[-1] += 3_000_000
    path = write(tmp_path / "clip.mkv", stamps)
    assert video_stamps(path) == stamps
    assert [stamp for stamp, _ in decoded_by_av(path)] == stamps
    assert cv2.VideoCapture(str(path)).get(cv2.CAP_PROP_FPS) == pytest.approx(25 / 6)


def test_colours_come_back(tmp_path: Path) -> None:
    """8 bits of 219 levels: 1; FFmpeg's scaler rounds down on the way back: 2 more. BT.709 instead: 30, 0..255: 16."""
    path = write(tmp_path / "clip.mkv", [0, SECOND_NS, 2 * SECOND_NS])
    for images in ([image for _, image in decoded_by_av(path)], decoded_by_opencv(path)):
        assert len(images) == 3
        for k, image in enumerate(images):
            assert np.abs(middles(image) - middles(patches(k))).max() <= 4


def test_planes_are_those_of_the_standard() -> None:
    """White, black, pure blue and pure red in BT.601: 235, 16; (41, 240, 110); (81, 90, 240)."""
    planes = yuv420(patches())
    assert planes.shape == (96, 128)
    bright, blue, red = planes[:64], planes[64:80].reshape(32, 64), planes[80:].reshape(32, 64)
    assert (bright[0, 96], bright[32, 0], bright[0, 0], bright[0, 64]) == (235, 16, 41, 81)
    assert (blue[0, 0], red[0, 0], blue[0, 32], red[0, 32]) == (240, 110, 90, 240)
    assert (blue[0, 48], red[16, 0]) == (128, 128)


def test_what_was_written_is_there_when_it_is_cut_off(tmp_path: Path) -> None:
    path = write(tmp_path / "clip.mkv", [k * SECOND_NS for k in range(60)])
    cut = tmp_path / "cut.mkv"
    cut.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    assert len(decoded_by_opencv(cut)) > 15


@pytest.mark.parametrize("stamps", [[5], [0, 0], [2 * SECOND_NS, SECOND_NS]])
def test_stamps_that_the_file_cannot_hold_are_refused(stamps: list[int], tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="whole ms after"):
        write(tmp_path / "clip.mkv", stamps)


def test_other_sizes_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="even width and height"):
        ClipWriter(tmp_path / "clip.mkv", 31, 32, rate_hz=Fraction(1), crf=20.0)
    with (
        ClipWriter(tmp_path / "clip.mkv", 32, 32, rate_hz=Fraction(1), crf=20.0) as writer,
        pytest.raises(ValueError, match="expected 32 x 32"),
    ):
        writer.write(patches(), 0)
