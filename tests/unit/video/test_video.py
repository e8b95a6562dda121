# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Video: lossless where it says so, stamps kept, damage told, readable without having been closed."""

import contextlib
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fairlead.io.errors import InputError
from fairlead.sources.video import VideoSource, without_password
from fairlead.types import Camera
from fairlead.video import VideoWriter
from tests.clip import CAMERA, PERIOD_NS, Clip


def test_ffv1_gives_every_bit_and_stamp_back(clip: Clip, tmp_path: Path) -> None:
    source = VideoSource(clip.first(5).write_video(tmp_path / "v.mkv"), CAMERA)
    frames = list(source)
    assert [each.frame for each in frames] == list(range(5))
    assert [each.stamp_ns for each in frames] == [PERIOD_NS * i for i in range(5)]
    for each, image in zip(frames, clip.images, strict=False):
        assert (each.image == image).all()
    assert source.count() == 5


def test_stamps_may_be_uneven(clip: Clip, tmp_path: Path) -> None:
    stamps = [0, 7_000_000, 300_000_000, 301_000_000]
    with VideoWriter(tmp_path / "v.mkv", codec="ffv1") as writer:
        for stamp_ns in stamps:
            writer.write(clip.images[0], 5_000_000_000 + stamp_ns)
    assert [each.stamp_ns for each in VideoSource(tmp_path / "v.mkv", CAMERA)] == stamps


def test_odd_sizes_and_h264(tmp_path: Path) -> None:
    image = np.full((61, 83, 3), 90, np.uint8)
    with VideoWriter(tmp_path / "v.mkv") as writer:
        writer.write(image, 0)
        writer.write(image, 40_000_000)
    frames = list(VideoSource(tmp_path / "v.mkv", sized(84, 62)))
    assert len(frames) == 2
    assert np.abs(frames[0].image.astype(int) - 90).max() <= 6  # of the codec


def readable(path: Path) -> list[int]:
    """Frames up to the end or to where it breaks off."""
    frames = []
    with contextlib.suppress(InputError):
        frames += (each.frame for each in VideoSource(path, CAMERA))
    return frames


def write_all(writer: VideoWriter, clip: Clip) -> None:
    for image, stamp_ns in zip(clip.images, clip.stamps_ns, strict=True):
        writer.write(image, stamp_ns)


def sized(width: int, height: int) -> Camera:
    return replace(CAMERA, width=width, height=height)


@pytest.mark.parametrize("codec", ["h264", "ffv1"])
def test_an_unfinished_file_can_be_read_up_to_the_last_image(clip: Clip, tmp_path: Path, codec: str) -> None:
    writer = VideoWriter(tmp_path / "v.mkv", codec=codec)  # pyright: ignore[reportArgumentType]
    for i in range(20):
        writer.write(clip.images[i], PERIOD_NS * i)
    shutil.copy(tmp_path / "v.mkv", tmp_path / "killed.mkv")
    writer.close()
    assert len(readable(tmp_path / "killed.mkv")) >= 18


def test_damage_is_told_after_what_could_be_read(clip: Clip, tmp_path: Path) -> None:
    path = clip.write_video(tmp_path / "v.mkv")
    data = bytearray(path.read_bytes())
    rng = np.random.default_rng(0)
    middle = len(data) // 2
    data[middle : middle + 3000] = rng.integers(0, 256, 3000, dtype=np.uint8).tobytes()
    path.write_bytes(data)
    with pytest.raises(InputError, match=r"v\.mkv: damaged after [0-9]+ images"):
        list(VideoSource(path, CAMERA))
    assert 5 < len(readable(path)) < 40


@pytest.mark.parametrize("data", [b"", b"no video at all" * 100, b"\x1aE\xdf\xa3" + bytes(400)])
def test_what_is_no_video_is_one_line(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "v.mkv").write_bytes(data)
    with pytest.raises(InputError, match=r"v\.mkv"):
        list(VideoSource(tmp_path / "v.mkv", CAMERA))


def test_another_size_is_an_error(clip: Clip, tmp_path: Path) -> None:
    path = clip.first(1).write_video(tmp_path / "v.mkv")
    with pytest.raises(InputError, match="expected 640 x 480 as the camera has, got images of 320 x 240"):
        VideoSource(path, sized(640, 480))


def test_a_place_that_is_not_there_and_a_full_disk_are_os_errors(clip: Clip, tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"none/v\.mkv"):
        VideoWriter(tmp_path / "none" / "v.mkv")
    if Path("/dev/full").exists():
        (tmp_path / "full.mkv").symlink_to("/dev/full")
        writer = VideoWriter(tmp_path / "full.mkv", codec="ffv1")
        with pytest.raises(OSError, match=r"No space left on device.*full\.mkv"):
            write_all(writer, clip)
        with contextlib.suppress(OSError):
            writer.close()


def test_passwords_are_not_shown() -> None:
    assert without_password("rtsp://me:secret@cam.local:554/a?b=c") == "rtsp://***@cam.local:554/a?b=c"
    assert without_password("rtsp://cam/a") == "rtsp://cam/a"
