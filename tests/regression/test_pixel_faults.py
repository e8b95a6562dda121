# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What goes wrong in front of and inside a camera, in pixels: the estimate is right or says that it is not valid."""

import hashlib
import itertools
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mcap.exceptions import EndOfFile
from mcap.reader import NonSeekingReader

from fairlead import Tracker, load_target
from fairlead.detect import Detector, detector_from_spec
from fairlead.geometry import exp_se3
from fairlead.inputs import DetectedViews
from fairlead.io.poses import read_poses
from fairlead.sources.source import ImageFrame
from fairlead.types import Correlation, Estimate, Target, View
from fairlead.video import VideoWriter
from tests.clip import CAMERA, DETECTOR, PERIOD_NS, Clip, draw, true_pose
from tests.regression.test_pipeline import overlay_frames

SEEN: dict[bytes, View] = {}
"""What the detector says of an image, by its bytes: the tests share most of theirs."""
RIGHT_M = 0.004
"""Half a per cent of the distance: 0.3 px at f = 420 px over 60 px of tags."""


@pytest.fixture(scope="module")
def target(clip: Clip) -> Target:
    return load_target(clip.folder / "target.toml")


class Images:
    """Numbered images with stamps, as a source gives them."""

    def __init__(self, frames: Iterable[tuple[int, int, np.ndarray]]) -> None:
        self._frames = [
            ImageFrame(frame=frame, stamp_ns=stamp_ns, path=Path("drawn"), image=image)
            for frame, stamp_ns, image in frames
        ]

    def __iter__(self):
        return iter(self._frames)

    def count(self) -> int:
        return len(self._frames)


class Remembering:
    """A detector that looks at each image once."""

    correlation = Correlation()

    def __init__(self, target: Target) -> None:
        self._detector: Detector = detector_from_spec(DETECTOR, target)

    def detect(self, image: np.ndarray, frame: int, stamp_ns: int) -> View:
        key = hashlib.sha256(image.tobytes()).digest()
        if key not in SEEN:
            SEEN[key] = self._detector.detect(image, 0, 0)
        return replace(SEEN[key], frame=frame, stamp_ns=stamp_ns)

    def follow(self, estimate: Estimate) -> None:
        self._detector.follow(estimate)


def follow(target: Target, frames: Iterable[tuple[int, int, np.ndarray]]) -> list[Estimate]:
    views = DetectedViews(Images(frames), Remembering(target))
    tracker = Tracker(target, CAMERA)
    return [tracker.update(view) for view in views]


def stamped(images: Iterable[np.ndarray]) -> list[tuple[int, int, np.ndarray]]:
    return [(frame, PERIOD_NS * frame, image) for frame, image in enumerate(images)]


def is_right(estimate: Estimate, T: np.ndarray) -> bool:
    return estimate.ok and bool(np.abs(estimate.T_camera_target[:3, 3] - T[:3, 3]).max() < RIGHT_M)


def noisy(image: np.ndarray, seed: int) -> np.ndarray:
    noise = np.random.default_rng(seed).integers(-2, 3, image.shape)
    return np.clip(image.astype(int) + noise, 0, 255).astype(np.uint8)


def test_covered_for_three_seconds(clip: Clip, target: Target) -> None:
    covered = range(6, 36)
    images = [noisy(draw_ground() if i in covered else image, i) for i, image in enumerate(clip.images)]
    estimates = follow(target, stamped(images))
    assert all(is_right(estimates[i], true_pose(i)) for i in range(2, 6))
    sizes = [np.trace(e.covariance[:3, :3]) for e in estimates[5:40] if e.status == "coasting"]
    assert len(sizes) >= 2
    assert all(later > earlier for earlier, later in itertools.pairwise(sizes)), "coasting grows less sure"
    for i in range(6 + 5, 36):  # half a second
        assert not estimates[i].ok, i
        assert np.isnan(estimates[i].T_camera_target).all()
    assert is_right(estimates[38], true_pose(38)), "found again within a second"
    assert is_right(estimates[39], true_pose(39))


def draw_ground() -> np.ndarray:
    return np.full((CAMERA.height, CAMERA.width, 3), 140, np.uint8)


def test_out_of_the_image_and_back(target: Target) -> None:
    """It leaves on the left, is away for 0.8 s, and comes back."""
    places = np.concatenate([np.linspace(0.0, -0.42, 8), np.full(8, -0.6), np.linspace(-0.42, 0.0, 8)])
    poses = [
        exp_se3(np.array([x, 0.0, 0.75, 0.0, 0.0, 0.0])) @ exp_se3(np.array([0, 0, 0, 0.1, 0.1, 0.0])) for x in places
    ]
    estimates = follow(target, stamped(noisy(draw(T), i) for i, T in enumerate(poses)))
    assert all(is_right(estimates[i], poses[i]) for i in range(1, 5))
    assert all(not estimates[i].ok for i in range(13, 16))
    assert all(is_right(estimates[i], poses[i]) for i in range(21, 24))
    for estimate, T in zip(estimates, poses, strict=True):
        if estimate.status == "tracking":  # half seen is worse seen, and says so
            off = estimate.T_camera_target[:3, 3] - T[:3, 3]
            sigma = np.sqrt(np.trace(estimate.covariance[:3, :3]))
            assert np.linalg.norm(off) < max(RIGHT_M, 5.0 * sigma)


def test_the_camera_jumps(clip: Clip, target: Target) -> None:
    """Somebody kicks it: turned by 25 degrees about its axis and moved by 10 cm between two images."""
    kick = exp_se3(np.array([0.05, 0.03, 0.1, 0.0, 0.0, 0.44]))
    poses = [true_pose(i) if i < 12 else kick @ true_pose(i) for i in range(22)]
    images = [clip.images[i] if i < 12 else draw(poses[i]) for i in range(22)]
    estimates = follow(target, stamped(noisy(image, i) for i, image in enumerate(images)))
    assert all(is_right(estimates[i], poses[i]) for i in range(2, 12))
    assert all(is_right(estimates[i], poses[i]) for i in range(16, 22)), "right again within 0.4 s"
    for i in range(12, 16):
        if estimates[i].status == "tracking":
            assert is_right(estimates[i], poses[i]), "never wrong and sure of it"


def test_a_frozen_camera_is_no_measurement(clip: Clip, target: Target, caplog: pytest.LogCaptureFixture) -> None:
    """The same image again and again while time goes on: the pose is not valid after half a second."""
    images = [noisy(image, i) for i, image in enumerate(clip.images[:26])]
    for i in range(10, 20):
        images[i] = images[9]
    estimates = follow(target, stamped(images))
    assert "frame 10 repeats the one before it: the camera froze" in caplog.text
    assert len(caplog.records) == 1
    assert all(is_right(estimates[i], true_pose(i)) for i in range(2, 10))
    assert all(not estimates[i].ok for i in range(15, 20))
    assert all(is_right(estimates[i], true_pose(i)) for i in range(22, 26))


def test_stamps_that_stand_still_or_go_back_are_dropped(clip: Clip, target: Target) -> None:
    frames = stamped(noisy(image, i) for i, image in enumerate(clip.images[:20]))
    frames[8] = (8, frames[7][1], frames[8][2])
    frames[11] = (11, frames[4][1], frames[11][2])
    estimates = follow(target, frames)
    for i, estimate in enumerate(estimates):
        if i in (8, 11):
            assert estimate.reason != ""
        elif i >= 2:
            assert is_right(estimate, true_pose(i)), i


def test_dropped_frames_are_not_missed(clip: Clip, target: Target) -> None:
    kept = [
        frame
        for frame in stamped(noisy(image, i) for i, image in enumerate(clip.images[:26]))
        if frame[0] not in {4, 7, 8, 12, 13, 14, 20, 21, 22, 23}
    ]
    estimates = follow(target, kept)
    assert len(estimates) == 16
    assert all(is_right(estimate, true_pose(estimate.frame)) for estimate in estimates[2:])


@pytest.fixture(scope="module")
def long_video(clip: Clip, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The clip there and back again, 300 images."""
    path = tmp_path_factory.mktemp("long") / "long.mkv"
    with VideoWriter(path, codec="ffv1") as writer:
        for i in range(300):
            place = i % 78
            writer.write(clip.images[place if place < 40 else 78 - place], PERIOD_NS * i)
    return path


def start(clip: Clip, video: Path, folder: Path) -> "subprocess.Popen[str]":
    sinks = ["--overlay", str(folder / "o.mkv"), "--mcap", str(folder / "o.mcap")]
    command = [sys.executable, "-m", "fairlead", *clip.arguments(video, folder / "run", *sinks)]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, env=os.environ | {"OMP_NUM_THREADS": "1"})


def wait_for_poses(path: Path, count: int, process: "subprocess.Popen[str]") -> None:
    end_s = time.monotonic() + 120.0
    while not path.exists() or path.read_bytes().count(b"\n") < count:
        assert process.poll() is None, process.communicate()[1]
        assert time.monotonic() < end_s
        time.sleep(0.02)


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT])
def test_every_file_can_be_read_when_it_is_stopped(
    clip: Clip, long_video: Path, tmp_path: Path, number: signal.Signals
) -> None:
    process = start(clip, long_video, tmp_path)
    wait_for_poses(tmp_path / "run" / "poses.csv", 25, process)
    process.send_signal(number)
    _, error = process.communicate(timeout=60)
    assert process.returncode == (-9 if number == signal.SIGKILL else 130)
    assert error == ("" if number == signal.SIGKILL else "fairlead: stopped; what was written stays readable\n")
    count = len(read_poses(tmp_path / "run" / "poses.csv"))
    assert count >= 24
    state = json.loads((tmp_path / "run" / "run.json").read_text())["state"]
    assert state == ("running" if number == signal.SIGKILL else "interrupted")
    assert abs(overlay_frames(tmp_path / "o.mkv") - count) <= 2
    topics = []
    with (tmp_path / "o.mcap").open("rb") as stream:
        try:
            for _, channel, _ in NonSeekingReader(stream).iter_messages(log_time_order=False):
                topics.append(channel.topic)
        except EndOfFile:
            assert number == signal.SIGKILL
    assert abs(topics.count("/diagnostics") - count) <= 1
