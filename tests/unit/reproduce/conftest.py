# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A short sequence about the frigate with tables of two detectors, and no image."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fairlead.io.camera import load_camera, save_camera
from fairlead.io.observations import write_views
from fairlead.io.poses import write_truth
from fairlead.io.shipped import shipped_data
from fairlead.io.target import load_target
from fairlead.reproduce.measured import observe
from fairlead.reproduce.methods import Flight
from fairlead.reproduce.sequences import Sequence, load_sequence
from fairlead.reproduce.work import flight_of
from fairlead.simulate import ArcScenario, project_all
from fairlead.types import TruthPose, View

TARGET = shipped_data("frigate") / "target.toml"


def views_of(folder: Path, sigma_px: float, seed: int, constant_px: float = 0.0) -> list[View]:
    """Landmarks of the true poses in a folder, with white noise and an error that stays."""
    target, camera = load_target(TARGET), load_camera(folder / "camera.yaml")
    rng = np.random.default_rng(seed)
    from fairlead.io.poses import read_truth

    truth = read_truth(folder / "truth.csv")
    pixels = project_all(camera, target.positions, np.array([pose.T_camera_target for pose in truth]))
    pixels += sigma_px * rng.standard_normal(pixels.shape) + constant_px * rng.standard_normal(pixels.shape[1:])
    S = np.tile(sigma_px**2 * np.eye(2), (len(target.landmarks), 1, 1))
    return [
        View(frame=p.frame, stamp_ns=p.stamp_ns, landmarks=target.landmarks, pixels=z, covariances=S)
        for p, z in zip(truth, pixels, strict=True)
    ]


@pytest.fixture(scope="session")
def make_sequence() -> Callable[..., Path]:
    """Write a folder: an arc at 1 km, a view every half second."""

    def make(folder: Path, views: int = 12, angle_deg: float = 40.0) -> Path:
        folder.mkdir(parents=True)
        save_camera(folder / "camera.yaml", load_camera(shipped_data("frigate") / "camera.yaml"))
        T = ArcScenario(angle_deg=angle_deg, views=views, interval_s=0.5).poses(load_target(TARGET).positions)
        truth = [TruthPose(frame=2 * k, stamp_ns=500_000_000 * k, T_camera_target=each) for k, each in enumerate(T)]
        write_truth(folder / "truth.csv", truth)
        (folder / "detections").mkdir()
        for seed, (name, sigma_px) in enumerate((("heat-t", 0.7), ("rtmpose-t", 1.4))):
            write_views(folder / "detections" / f"{name}.csv", views_of(folder, sigma_px, seed + 2))
        return folder

    return make


@pytest.fixture(scope="session")
def sequence(make_sequence: Callable[..., Path], tmp_path_factory: pytest.TempPathFactory) -> Sequence:
    folder = make_sequence(tmp_path_factory.mktemp("sequences") / "orbit-2.0")
    return load_sequence(folder, TARGET, folder)


@pytest.fixture(scope="session")
def flight(sequence: Sequence) -> Flight:
    """Told model 3 and white noise of 0.7 px."""
    views = views_of(sequence.folder, 0.7, 5)
    return flight_of(sequence, views, observe(sequence, views), 3)
