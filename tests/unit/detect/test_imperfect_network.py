# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Acquiring and following with a network that errs: it misses landmarks, has heavy tails and knows few scales."""

from pathlib import Path

import numpy as np
import pytest

from fairlead import geometry
from fairlead.detect.network import NetworkDetector
from fairlead.io.camera import load_camera
from fairlead.io.shipped import shipped_data
from fairlead.io.target import load_target
from fairlead.tracker import Tracker
from fairlead.types import Camera, Matrix4, Target
from tests.unit.detect.imperfect import ImperfectNetwork, ramps

IMAGE = ramps()


@pytest.fixture(scope="module")
def frigate() -> tuple[Target, Camera]:
    folder = shipped_data("frigate")
    return load_target(folder / "target.toml"), load_camera(folder / "camera.yaml")


def detector(
    monkeypatch: pytest.MonkeyPatch, frigate: tuple[Target, Camera], rng: np.random.Generator
) -> tuple[NetworkDetector, ImperfectNetwork]:
    """With true landmarks that are a metre off the told ones."""
    target, camera = frigate
    X_true = target.positions + rng.standard_normal(target.positions.shape)
    network = ImperfectNetwork(target.landmarks, X_true, camera, rng)
    monkeypatch.setattr("fairlead.detect.network.Network", lambda _: network)
    return NetworkDetector(Path("imperfect.onnx"), target, camera), network


def from_astern(target: Target, range_m: float, azimuth_rad: float, off_rad: tuple[float, float]) -> Matrix4:
    """15 degrees above the water, the camera not quite pointed at the target."""
    middle = 0.5 * (target.positions.min(axis=0) + target.positions.max(axis=0))
    level, up = np.cos(np.radians(15.0)), np.sin(np.radians(15.0))
    d = np.array([-level * np.cos(azimuth_rad), -level * np.sin(azimuth_rad), up])
    right = np.cross(-d, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    R = np.array([right, np.cross(-d, right), -d])
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, -R @ (middle + range_m * d)
    turn = np.eye(4)
    turn[:3, :3] = geometry.exp_so3(np.array([*off_rad, 0.0]))
    return turn @ T


@pytest.mark.parametrize("range_m", [500.0, 1000.0, 1500.0])
def test_it_is_found_in_the_first_image(
    monkeypatch: pytest.MonkeyPatch, frigate: tuple[Target, Camera], range_m: float
) -> None:
    rng, found = np.random.default_rng(int(range_m)), 0
    for _ in range(20):
        one, network = detector(monkeypatch, frigate, rng)
        off = rng.uniform(-0.1, 0.1, 2)
        T = from_astern(frigate[0], range_m, rng.uniform(-3.1, 3.1), (off[0], off[1]))
        network.T_camera_target = T
        view = one.detect(IMAGE, 0, 0)
        if view.landmarks:
            rows = [frigate[0].landmarks.index(name) for name in view.landmarks]
            truth = geometry.project(frigate[1], geometry.transform(T, frigate[0].positions))[rows]
            off_px = np.median(np.linalg.norm(view.pixels - truth, axis=1))
            found += off_px < 10.0  # a metre of the model is 4 px at 500 m
    assert found >= 19


def test_a_small_one_is_found_a_few_images_later(
    monkeypatch: pytest.MonkeyPatch, frigate: tuple[Target, Camera]
) -> None:
    rng, found = np.random.default_rng(8), 0
    for _ in range(3):
        one, network = detector(monkeypatch, frigate, rng)
        for k in range(30):
            network.T_camera_target = from_astern(frigate[0], 3000.0, 0.1, (0.05, -0.08))
            if one.detect(IMAGE, k, k * 40_000_000).landmarks:
                found += 1
                break
    assert found == 3


def test_noise_is_not_believed(monkeypatch: pytest.MonkeyPatch, frigate: tuple[Target, Camera]) -> None:
    one, network = detector(monkeypatch, frigate, np.random.default_rng(9))
    assert network.T_camera_target is None
    assert sum(len(one.detect(IMAGE, k, k * 40_000_000).landmarks) > 0 for k in range(15)) == 0


@pytest.mark.parametrize("rate", [25, 5])
def test_it_is_followed_though_the_camera_sways(
    monkeypatch: pytest.MonkeyPatch, frigate: tuple[Target, Camera], rate: int
) -> None:
    one, network = detector(monkeypatch, frigate, np.random.default_rng(rate))
    tracker = Tracker(*frigate)
    states: list[str] = []
    for k in range(60):
        t = k / rate
        off = (0.035 * np.sin(1.9 * t), 0.035 * np.cos(1.4 * t))
        network.T_camera_target = from_astern(frigate[0], 1000.0, 0.06 * t, off)
        estimate = tracker.update(one.detect(IMAGE, k, round(1e9 * t)))
        one.follow(estimate)
        states.append(estimate.status)
    assert states.count("tracking") >= 59
    assert one.acquisitions <= 2
    assert network.looks < 60 + 2 * 40
