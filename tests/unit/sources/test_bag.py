# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Images out of ROS recordings: every bit, the stamp of the header, the calibration; damage is told."""

import contextlib
import logging
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fairlead.io.errors import InputError
from fairlead.sources.bag import BagSource, bag_camera
from tests.bags import records, write_bag, write_mcap
from tests.clip import CAMERA, PERIOD_NS, Clip


def readable(path: Path) -> list[int]:
    """Frames up to the end or to where it breaks off."""
    frames: list[int] = []
    with contextlib.suppress(InputError):
        for each in BagSource(path, CAMERA):
            frames.append(each.frame)  # noqa: PERF401 - it may break off
    return frames


@pytest.mark.parametrize("encoding", ["png", "bgr8", "rgb8", "mono8"])
def test_mcap_gives_every_bit_and_the_stamp_of_the_header(clip: Clip, tmp_path: Path, encoding: str) -> None:
    recorded = records(clip.images[:3], clip.stamps_ns[:3], CAMERA, encoding)
    source = BagSource(write_mcap(tmp_path / "a.mcap", recorded), CAMERA)
    frames = list(source)
    assert source.count() == 3
    assert [each.stamp_ns for each in frames] == [3_000_000, PERIOD_NS, 2 * PERIOD_NS]  # a stamp of 0 is none
    for each, image in zip(frames, clip.images, strict=False):
        assert (each.image == image).all()


def test_a_bag_of_ros_2_gives_the_same(clip: Clip, tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "bag", records(clip.images[:3], clip.stamps_ns[:3], CAMERA, "bgr8"))
    source = BagSource(bag, CAMERA)
    frames = list(source)
    assert source.count() == 3
    assert [each.stamp_ns for each in frames][1:] == [PERIOD_NS, 2 * PERIOD_NS]
    assert all((each.image == image).all() for each, image in zip(frames, clip.images, strict=False))
    assert (bag_camera(bag).K == CAMERA.K).all()


def test_the_calibration_is_in_the_recording(clip: Clip, tmp_path: Path) -> None:
    path = write_mcap(tmp_path / "a.mcap", records(clip.images[:1], [5], CAMERA))
    camera = bag_camera(path)
    assert (camera.width, camera.height, camera.model, camera.name) == (320, 240, "plumb_bob", "optical")
    assert (camera.K == CAMERA.K).all()


def test_another_calibration_is_used_and_said(clip: Clip, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = write_mcap(tmp_path / "a.mcap", records(clip.images[:1], [5], CAMERA))
    BagSource(path, CAMERA)
    assert caplog.records == []
    with caplog.at_level(logging.WARNING):
        BagSource(path, replace(CAMERA, K=CAMERA.K + np.diag([4.0, 4.0, 0.0])))
    assert "differs from the camera by 4 px" in caplog.text
    with pytest.raises(InputError, match="expected 640 x 480 as the camera has, got images of 320 x 240"):
        BagSource(path, replace(CAMERA, width=640, height=480))


def test_no_calibration_no_images_and_too_many(clip: Clip, tmp_path: Path) -> None:
    bare = write_mcap(tmp_path / "bare.mcap", records(clip.images[:1], [5], None))
    with pytest.raises(InputError, match="holds no calibrated CameraInfo"):
        bag_camera(bare)
    empty = write_mcap(tmp_path / "empty.mcap", records((), [], CAMERA))
    with pytest.raises(InputError, match=r"holds no images; its topics: /cam/camera_info"):
        BagSource(empty, CAMERA)
    two = list(records(clip.images[:1], [5], CAMERA)) + [
        ("/rear/image", *each[1:]) for each in records(clip.images[1:2], [5], None)
    ]
    both = write_mcap(tmp_path / "two.mcap", iter(two))
    with pytest.raises(InputError, match=r"/cam/image, /rear/image: say which with --topic"):
        BagSource(both, CAMERA)
    with pytest.raises(InputError, match=r"did you mean '/rear/image'"):
        BagSource(both, CAMERA, topic="/rear/imag")
    assert (next(iter(BagSource(both, CAMERA, topic="/rear/image"))).image == clip.images[1]).all()


def test_a_recording_cut_in_half_gives_half_and_says_so(clip: Clip, tmp_path: Path) -> None:
    path = write_mcap(tmp_path / "a.mcap", records(clip.images, clip.stamps_ns, CAMERA), chunk_size=20_000)
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])
    with pytest.raises(InputError, match=r"a\.mcap: damaged after [0-9]+ messages"):
        list(BagSource(path, CAMERA))
    assert 12 <= len(readable(path)) <= 20
    assert (bag_camera(path).K == CAMERA.K).all()


def test_damage_never_raises_anything_else(clip: Clip, tmp_path: Path) -> None:
    path = write_mcap(tmp_path / "a.mcap", records(clip.images[:4], clip.stamps_ns[:4], CAMERA), chunk_size=4_000)
    data = path.read_bytes()
    rng = np.random.default_rng(3)
    for _ in range(40):
        broken = bytearray(data)
        for place in rng.integers(0, len(data), 12):
            broken[place] = rng.integers(0, 256)
        path.write_bytes(broken)
        assert len(readable(path)) <= 4


@pytest.mark.parametrize("data", [b"", b"nothing" * 50, b"\x89MCAP0\r\n"])
def test_what_is_no_recording_is_one_line(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "a.mcap").write_bytes(data)
    with pytest.raises(InputError, match=r"a\.mcap"):
        BagSource(tmp_path / "a.mcap", CAMERA)
    (tmp_path / "bag").mkdir()
    (tmp_path / "bag" / "metadata.yaml").write_bytes(data)
    with pytest.raises(InputError, match="bag"):
        BagSource(tmp_path / "bag", CAMERA)
