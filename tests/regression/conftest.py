# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A small flight on disk, for tests of the command line."""

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from fairlead.cameras import project
from fairlead.cli import main
from fairlead.geometry import exp_se3, transform
from fairlead.io.camera import save_camera
from fairlead.io.observations import write_views
from fairlead.io.poses import write_truth
from fairlead.io.target import load_target
from fairlead.types import Camera, TruthPose, View

TARGET = """name = "box"
[prior]
sigma_m = 0.1
""" + "".join(
    f'[[landmark]]\nname = "p{index}"\nposition_m = [{x}.0, {y}.0, {z}.0]\n'
    for index, (x, y, z) in enumerate(
        [(1, 1, 1), (-1, 1, -1), (-1, -1, 1), (1, -1, -1), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    )
)


@dataclass(frozen=True, kw_only=True)
class Flight:
    """Files of one flight, and a folder for results."""

    folder: Path

    @property
    def source(self) -> Path:
        return self.folder / "observations.csv"

    @property
    def out(self) -> Path:
        return self.folder / "run"

    def arguments(self, verb: str = "track", **changes: str | Path) -> list[str]:
        """The command line; a change names an option without its dashes."""
        options = {"target": self.folder / "target.toml", "camera": self.folder / "camera.yaml", "output": self.out}
        words = [verb, str(changes.pop("source", self.source))]
        for name, value in (options | changes).items():
            words += [f"--{name.replace('_', '-')}", str(value)]
        return words

    def run(self, verb: str = "track", **changes: str | Path) -> int:
        """Run in this process; returns the exit status."""
        return main(self.arguments(verb, **changes))

    def start(self, verb: str = "track", **changes: str | Path) -> subprocess.Popen[str]:
        """Run in a process of its own."""
        command = [sys.executable, "-m", "fairlead", *self.arguments(verb, **changes)]
        return subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=os.environ.copy()
        )


def make_flight(folder: Path, frames: int) -> Flight:
    """A camera that circles a box of seven landmarks at 6 m, 10 frames a second, 0.5 px of noise."""
    (folder / "target.toml").write_text(TARGET)
    target = load_target(folder / "target.toml")
    K = np.array([[600.0, 0.0, 320.0], [0.0, 600.0, 240.0], [0.0, 0.0, 1.0]])
    camera = Camera(name="c", width=640, height=480, model="plumb_bob", K=K, distortion=np.zeros(5))
    save_camera(folder / "camera.yaml", camera)
    rng = np.random.default_rng(7)
    views: list[View] = []
    truth: list[TruthPose] = []
    for frame in range(frames):
        T = exp_se3(np.array([0.0, 0.0, 6.0, 0.0, 0.0, 0.0])) @ exp_se3(
            np.array([0.0, 0.0, 0.0, 0.3, 0.01 * frame, 0.0])
        )
        pixels = project(camera, transform(T, target.positions)) + rng.normal(0.0, 0.5, (7, 2))
        covariances = np.tile(0.25 * np.eye(2), (7, 1, 1))
        stamp_ns = 100_000_000 * frame
        landmarks = target.landmarks
        views.append(View(frame=frame, stamp_ns=stamp_ns, landmarks=landmarks, pixels=pixels, covariances=covariances))
        truth.append(TruthPose(frame=frame, stamp_ns=stamp_ns, T_camera_target=T))
    write_views(folder / "observations.csv", views)
    write_truth(folder / "truth.csv", truth)
    return Flight(folder=folder)


@pytest.fixture
def flight(tmp_path: Path) -> Flight:
    return make_flight(tmp_path, 20)


@pytest.fixture(scope="session")
def _long_flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("long")
    make_flight(folder, 400)
    lines = (folder / "observations.csv").read_text().splitlines()
    with (folder / "observations.csv").open("w") as stream:  # round and round, 4,000 frames
        stream.write(lines[0] + "\n")
        for turn in range(10):
            for line in lines[1:]:
                frame, _, rest = line.split(",", 2)
                number = int(frame) + 400 * turn
                stream.write(f"{number},{100_000_000 * number},{rest}\n")
    return folder


@pytest.fixture
def long_flight(_long_flight: Path, tmp_path: Path) -> Flight:
    """4,000 frames; results go into a folder of the test."""
    for name in ("observations.csv", "target.toml", "camera.yaml"):
        (tmp_path / name).symlink_to(_long_flight / name)
    return Flight(folder=tmp_path)
