# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""From images through a network to poses, by the command line: folders, BOP scenes, and files that do not fit."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fairlead import geometry
from fairlead.cli import main
from fairlead.io.camera import save_camera
from fairlead.io.poses import read_poses
from fairlead.io.target import save_target
from fairlead.opencv.filters import write_image
from fairlead.types import Matrix4
from tests.unit.detect.networks import heat_network, saved
from tests.unit.detect.spots import draw, seen_from, spots_target, wide_camera
from tests.unit.detect.test_network_detector import CARD

FRAMES = 12


def truth(k: int) -> Matrix4:
    return seen_from(40.0 - 0.3 * k, aside_m=(0.2 * k, -0.1 * k), turn_rad=0.3 + 0.02 * k)


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """images/, target.toml, camera.yaml, spots.onnx."""
    camera = wide_camera(320, 240)
    (tmp_path / "images").mkdir()
    for k in range(FRAMES):
        write_image(tmp_path / "images" / f"{k:06d}.png", draw(camera, truth(k)).image)
    save_target(tmp_path / "target.toml", spots_target(0.01))
    save_camera(tmp_path / "camera.yaml", camera)
    saved(heat_network(CARD), tmp_path / "spots.onnx")
    return tmp_path


def arguments(scene: Path, verb: str = "track", source: str = "images") -> list[str]:
    files = ["--target", str(scene / "target.toml"), "--camera", str(scene / "camera.yaml"), "-o", str(scene / "run")]
    return [verb, str(scene / source), "--detector", str(scene / "spots.onnx"), "--fps", "25", *files]


@pytest.mark.parametrize("verb", ["track", "refine"])
def test_images_give_poses_from_the_first_frame_on(scene: Path, capsys: pytest.CaptureFixture[str], verb: str) -> None:
    assert main(arguments(scene, verb)) == 0
    assert capsys.readouterr().err == ""
    estimates = read_poses(scene / "run" / "poses.csv")
    assert len(estimates) == FRAMES
    for k, estimate in enumerate(estimates):
        assert estimate.ok
        xi = geometry.difference(truth(k), estimate.T_camera_target)
        assert np.linalg.norm(xi[:3]) < 0.02 * truth(k)[2, 3]
        assert np.linalg.norm(xi[3:]) < 0.03
    record = json.loads((scene / "run" / "run.json").read_text())
    assert [each["role"] for each in record["inputs"]] == ["source", "target", "camera", "detector"]


def test_a_scene_folder_gives_the_same(scene: Path) -> None:
    assert main(arguments(scene)) == 0
    plain = read_poses(scene / "run" / "poses.csv")
    camera = wide_camera(320, 240)
    (scene / "bop").mkdir()
    (scene / "images").rename(scene / "bop" / "rgb")
    cameras = {str(k): {"cam_K": camera.K.ravel().tolist(), "depth_scale": 1.0} for k in range(FRAMES)}
    (scene / "bop" / "scene_camera.json").write_text(json.dumps(cameras))
    poses = {
        str(k): [
            {"cam_R_m2c": truth(k)[:3, :3].ravel().tolist(), "cam_t_m2c": (1e3 * truth(k)[:3, 3]).tolist(), "obj_id": 1}
        ]
        for k in range(FRAMES)
    }
    (scene / "bop" / "scene_gt.json").write_text(json.dumps(poses))
    assert main(arguments(scene, source="bop")) == 0
    for a, b in zip(plain, read_poses(scene / "run" / "poses.csv"), strict=True):
        assert np.array_equal(a.T_camera_target, b.T_camera_target)


def test_a_network_that_does_not_fit_is_one_line_and_2(scene: Path, capsys: pytest.CaptureFixture[str]) -> None:
    network = scene / "spots.onnx"
    content = network.read_bytes()
    cases = {
        "the runtime refuses it": content[: len(content) // 2],
        "cannot be read": None,
        "carries no card": heat_network(None).SerializeToString(),
    }
    for said, written in cases.items():
        network.unlink(missing_ok=True)
        if written is not None:
            network.write_bytes(written)
        assert main(arguments(scene)) == 2
        error = capsys.readouterr().err
        assert error.count("\n") == 1
        assert said in error
        assert "spots.onnx" in error
        assert not (scene / "run").exists()


def test_a_network_for_another_target_is_one_line_and_2(scene: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = spots_target()
    save_target(
        scene / "target.toml", replace(target, landmarks=("rot", "gruen", "blau", "gelb", *target.landmarks[4:]))
    )
    assert main(arguments(scene)) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "expected the landmarks of target spots (rot, gruen" in error
