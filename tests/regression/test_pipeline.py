# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""From pixels to poses: the same clip in every form gives the same poses, and every sink what it promises."""

import contextlib
import json
import socket
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from fairlead.cli import main
from fairlead.io.errors import InputError
from fairlead.io.poses import read_poses
from fairlead.io.timing import read_timing
from fairlead.sources.video import VideoSource
from tests.bags import records, write_bag, write_mcap
from tests.clip import CAMERA, Clip, true_pose

SHORT = 8


def with_stamps(clip: Clip) -> list[int]:
    """A header without a stamp is none: the first image of a recording is not taken at 0."""
    return [stamp_ns + 1 for stamp_ns in clip.stamps_ns]


def test_every_form_of_a_clip_gives_the_same_poses(clip: Clip, tmp_path: Path) -> None:
    short = clip.first(SHORT)
    forms = {
        "video": short.write_video(tmp_path / "clip.mkv"),
        "images": short.write_images(tmp_path / "images"),
        "bop": short.write_bop(tmp_path / "bop"),
        "mcap": write_mcap(tmp_path / "clip.mcap", records(short.images, with_stamps(short), CAMERA)),
        "raw": write_bag(tmp_path / "bag", records(short.images, with_stamps(short), CAMERA, "bgr8")),
    }
    found = {}
    for name, source in forms.items():
        assert main(short.arguments(source, tmp_path / name)) == 0, name
        found[name] = read_poses(tmp_path / name / "poses.csv")
    for name, estimates in found.items():
        assert [e.frame for e in estimates] == list(range(SHORT)), name
        for ours, theirs in zip(estimates, found["images"], strict=True):
            assert ours.ok
            assert ours.stamp_ns - theirs.stamp_ns == (1 if name in ("mcap", "raw") else 0)
            assert (ours.T_camera_target == theirs.T_camera_target).all(), name
            assert (ours.covariance == theirs.covariance).all(), name
    for frame, estimate in enumerate(found["video"]):
        # A thousandth of the distance: 0.1 px at f = 420 px over tags of 45 px.
        assert np.abs(estimate.T_camera_target[:3, 3] - true_pose(frame)[:3, 3]).max() < 1e-3


def test_a_recording_brings_its_camera(clip: Clip, tmp_path: Path) -> None:
    short = clip.first(SHORT)
    path = write_mcap(tmp_path / "clip.mcap", records(short.images, with_stamps(short), CAMERA))
    arguments = short.arguments(path, tmp_path / "run")
    place = arguments.index("--camera")
    assert main(arguments[:place] + arguments[place + 2 :]) == 0
    assert len(read_poses(tmp_path / "run" / "poses.csv")) == SHORT


def test_every_sink_has_every_frame(clip: Clip, tmp_path: Path) -> None:
    short = clip.first(SHORT)
    sinks = ["--overlay", str(tmp_path / "o.mkv"), "--mcap", str(tmp_path / "o.mcap"), "--parquet"]
    assert main(short.arguments(short.write_video(tmp_path / "clip.mkv"), tmp_path / "run", *sinks)) == 0
    assert len(list(VideoSource(tmp_path / "o.mkv", CAMERA))) == SHORT
    table = pq.read_table(tmp_path / "run" / "poses.parquet")
    estimates = read_poses(tmp_path / "run" / "poses.csv")
    assert table["tx"].to_pylist() == [e.T_camera_target[0, 3] for e in estimates]
    assert table["stamp_ns"].to_pylist() == [e.stamp_ns for e in estimates]
    for timing in read_timing(tmp_path / "run" / "timing.csv"):
        assert min(timing.read_ms, timing.detect_ms, timing.update_ms, timing.sinks_ms) > 0.0


def test_an_autopilot_hears_of_it(clip: Clip, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    short = clip.first(SHORT)
    video = short.write_video(tmp_path / "clip.mkv")
    (tmp_path / "mount.toml").write_text("[camera]\npitch_deg = -90.0\n")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as pilot:
        pilot.bind(("127.0.0.1", 0))
        pilot.settimeout(0.0)
        address = f"udpout:127.0.0.1:{pilot.getsockname()[1]}"
        assert main(short.arguments(video, tmp_path / "run", "--mavlink", address)) == 2
        assert "expected --autopilot and --mount too" in capsys.readouterr().err
        more = ["--mavlink", address, "--autopilot", "ardupilot", "--mount", str(tmp_path / "mount.toml")]
        assert main(short.arguments(video, tmp_path / "run", *more)) == 0
        kinds = set()
        with contextlib.suppress(BlockingIOError):
            while data := pilot.recv(2048):
                kinds.add(int.from_bytes(data[7:10], "little"))
    assert {0, 111, 149, 253, 511} <= kinds  # heartbeat, TIMESYNC, LANDING_TARGET, STATUSTEXT, TARGET_RELATIVE


def test_sinks_do_not_write_over_what_is_read(clip: Clip, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    video = clip.first(2).write_video(tmp_path / "clip.mkv")
    before = video.read_bytes()
    assert main(clip.arguments(video, tmp_path / "run", "--overlay", str(video))) == 2
    assert "would be written over" in capsys.readouterr().err
    assert main(clip.arguments(video, tmp_path / "run", "--overlay", str(tmp_path / "o.mp4"))) == 2
    assert "ends in .mkv" in capsys.readouterr().err
    assert video.read_bytes() == before


@pytest.mark.parametrize("kind", ["video", "mcap"])
def test_a_damaged_source_is_one_line_and_2_and_keeps_its_poses(
    clip: Clip, tmp_path: Path, capsys: pytest.CaptureFixture[str], kind: str
) -> None:
    short = clip.first(20)
    if kind == "video":
        path = short.write_video(tmp_path / "clip.mkv")
    else:
        recorded = records(short.images, with_stamps(short), CAMERA)
        path = write_mcap(tmp_path / "clip.mcap", recorded, chunk_size=10_000)
    data = bytearray(path.read_bytes())
    if kind == "video":
        middle = len(data) // 2
        data[middle : middle + 3000] = np.random.default_rng(0).integers(0, 256, 3000, dtype=np.uint8).tobytes()
    else:
        data = data[: len(data) // 2]
    path.write_bytes(data)
    status = main(short.arguments(path, tmp_path / "run", "--overlay", str(tmp_path / "o.mkv")))
    error = capsys.readouterr().err
    assert status == 2
    assert error.count("\n") == 1
    assert f"{path}: damaged after" in error
    estimates = read_poses(tmp_path / "run" / "poses.csv")
    assert 5 <= len(estimates) < 20
    assert all(estimate.ok for estimate in estimates)
    assert json.loads((tmp_path / "run" / "run.json").read_text())["state"] == "failed"
    assert overlay_frames(tmp_path / "o.mkv") == len(estimates)


def overlay_frames(path: Path) -> int:
    count = 0
    with contextlib.suppress(InputError):
        for _ in VideoSource(path, CAMERA):
            count += 1
    return count
