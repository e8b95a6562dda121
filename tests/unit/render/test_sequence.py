# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Sequences and crops as files: what is written is true, is read back, and is not made twice."""

import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import av
import numpy as np
import pytest

from fairlead import geometry
from fairlead.cli import main
from fairlead.io.bop import BopFrame, is_bop, read_bop, write_bop
from fairlead.io.camera import load_camera, save_camera
from fairlead.io.coco import read_coco
from fairlead.io.errors import InputError
from fairlead.io.observations import read_views
from fairlead.io.poses import read_truth
from fairlead.io.target import load_target
from fairlead.opencv import read_image
from fairlead.render.crop_view import crop_camera
from fairlead.render.flights import FLIGHTS, Swell, fly
from fairlead.render.frame_files import DEPTH_STEP_MM
from fairlead.sources.bop import BopSource, bop_truth
from tests.unit.render.conftest import Shipped, pinhole


@pytest.fixture(scope="module")
def small_camera(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("camera") / "camera.yaml"
    save_camera(path, replace(pinhole(96, 180.0), model="plumb_bob", distortion=np.zeros(5)))
    return path


@pytest.fixture(scope="module")
def flight(graphics: None, frigate: Shipped, small_camera: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three frames of a rendezvous, with depth, through the command line."""
    out = tmp_path_factory.mktemp("flight")
    arguments = ["render", "rendezvous-20", "--quality", "draft", "--camera", str(small_camera), "--frames", "3"]
    assert main([*arguments, "--stride", "50", "--depth", "--swell", "-o", str(out)]) == 0
    return out


def test_a_sequence_is_a_scene_folder(flight: Path, frigate: Shipped) -> None:
    assert is_bop(flight)
    truth = read_truth(flight / "truth.csv")
    assert [pose.frame for pose in truth] == [0, 50, 100]
    assert [pose.stamp_ns for pose in truth] == [0, 2_000_000_000, 4_000_000_000]
    for frame, pose in zip(read_bop(flight), truth, strict=True):
        assert np.allclose(frame.T_camera_target, pose.T_camera_target, atol=1e-9)
    entry = json.loads((flight / "scene_gt.json").read_text())["0"][0]
    assert np.linalg.norm(entry["cam_t_m2c"]) == pytest.approx(1e3 * np.linalg.norm(truth[0].T_camera_target[:3, 3]))
    info = json.loads((flight / "scene_gt_info.json").read_text())["50"][0]
    assert 0 < info["px_count_visib"] <= info["px_count_all"]
    exact = load_target(flight / "target_true.toml")
    assert exact.landmarks == frigate.target.landmarks
    assert not exact.covariance.any()


def test_observations_are_projections_of_what_is_seen(flight: Path, frigate: Shipped, small_camera: Path) -> None:
    camera, truth = load_camera(small_camera), read_truth(flight / "truth.csv")
    views = list(read_views(flight / "observations_true.csv"))
    assert len(views) == 3
    for view, pose in zip(views, truth, strict=True):
        X = np.array([frigate.target.positions[frigate.target.landmarks.index(name)] for name in view.landmarks])
        expected = geometry.project(camera, geometry.transform(pose.T_camera_target, X))
        assert np.abs(view.pixels - expected).max() < 1e-9
        assert 4 < len(view.landmarks) < 20
    states = {line.rsplit(",", 1)[1] for line in (flight / "landmarks_true.csv").read_text().splitlines()[1:]}
    assert {"visible", "hidden"} <= states <= {"visible", "hidden", "outside"}


def test_masks_and_depth_fit_the_pose(flight: Path, frigate: Shipped, small_camera: Path) -> None:
    import cv2

    camera, pose = load_camera(small_camera), read_truth(flight / "truth.csv")[2]
    expected = frigate.caster.depth(camera, pose.T_camera_target)
    full = read_image(flight / "mask" / "000100_000000.png")[..., 0] > 0
    visible = read_image(flight / "mask_visib" / "000100_000000.png")[..., 0] > 0
    assert np.array_equal(full, np.isfinite(expected))
    assert (visible & ~full).sum() <= 0.01 * full.sum()
    depth = cv2.imread(str(flight / "depth" / "000100.png"), cv2.IMREAD_UNCHANGED)
    both = visible & full
    off = np.abs(depth[both] * DEPTH_STEP_MM / 1000.0 - expected[both])
    assert np.median(off) <= 0.5e-3 * DEPTH_STEP_MM
    assert (depth[~visible] == 0).all()


def test_a_frame_that_is_there_is_kept_and_one_that_is_missing_comes_back_the_same(
    flight: Path, small_camera: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    again = tmp_path / "again"
    shutil.copytree(flight, again)
    (again / "rgb" / "000050.png").unlink()
    (again / "rgb" / "000100.png").write_bytes(b"kept as it is")
    arguments = ["render", "rendezvous-20", "--quality", "draft", "--camera", str(small_camera), "--frames", "3"]
    assert main([*arguments, "--stride", "50", "--depth", "--swell", "-o", str(again)]) == 0
    assert "1 pictures made" in capsys.readouterr().out
    assert (again / "rgb" / "000050.png").read_bytes() == (flight / "rgb" / "000050.png").read_bytes()
    assert (again / "rgb" / "000100.png").read_bytes() == b"kept as it is"


def test_a_part_of_a_flight_becomes_a_clip(flight: Path, small_camera: Path, tmp_path: Path) -> None:
    """From frame 50 on: the same pictures; in the clip they count from 0, with their stamps."""
    scene, clip = tmp_path / "scene", tmp_path / "clip"
    arguments = ["render", "rendezvous-20", "--quality", "draft", "--camera", str(small_camera), "--stride", "50"]
    part = ["--swell", "--first", "1", "--frames", "2", "--clip", str(clip), "--crf", "4"]
    assert main([*arguments, *part, "-o", str(scene)]) == 0
    assert [pose.frame for pose in read_truth(scene / "truth.csv")] == [50, 100]
    whole, kept = read_truth(flight / "truth.csv")[1:], read_truth(clip / "truth.csv")
    assert [pose.frame for pose in kept] == [0, 1]
    for ours, theirs in zip(kept, whole, strict=True):
        assert ours.stamp_ns == theirs.stamp_ns
        assert np.array_equal(ours.T_camera_target, theirs.T_camera_target)
    assert load_camera(clip / "camera.yaml").width == 96
    assert load_target(clip / "target_true.toml").landmarks == load_target(flight / "target_true.toml").landmarks
    views = list(read_views(clip / "observations_true.csv"))
    assert [(view.frame, view.stamp_ns) for view in views] == [(0, 2_000_000_000), (1, 4_000_000_000)]
    with av.open(str(clip / "clip.mkv")) as container:
        decoded = list(container.decode(video=0))
    assert [round(frame.pts * frame.time_base * 10**9) for frame in decoded] == [pose.stamp_ns for pose in kept]
    for frame, number in zip(decoded, (50, 100), strict=True):
        rendered = read_image(flight / "rgb" / f"{number:06d}.png").astype(float)
        assert np.abs(frame.to_ndarray(format="bgr24") - rendered).mean() < 4.0


def test_a_scene_folder_is_a_source(flight: Path, small_camera: Path) -> None:
    camera = load_camera(small_camera)
    images = list(BopSource(flight, camera))
    assert [image.frame for image in images] == [0, 50, 100]
    assert [image.stamp_ns for image in images] == [0, 2_000_000_000, 4_000_000_000]
    truth = bop_truth(flight, camera)
    assert [pose.frame for pose in truth] == [0, 50, 100]


def test_a_scene_of_another_camera_is_refused(flight: Path, small_camera: Path) -> None:
    camera = load_camera(small_camera)
    K = camera.K.copy()
    K[0, 2] += 0.5
    with pytest.raises(InputError, match=r"differs from the camera by 0\.5 px"):
        BopSource(flight, replace(camera, K=K))


def test_scene_files_of_others_are_read(tmp_path: Path) -> None:
    """Millimetres, few decimals, several objects."""
    frame = BopFrame(frame=7, K=np.diag([500.0, 500.0, 1.0]), T_camera_target=np.eye(4), object_id=3)
    write_bop(tmp_path, [frame])
    table = json.loads((tmp_path / "scene_gt.json").read_text())
    table["7"][0]["cam_R_m2c"] = [0.99995, 0.01, 0, -0.01, 0.99995, 0, 0, 0, 1.0]
    table["7"][0]["cam_t_m2c"] = [10.0, -20.0, 1500.0]
    table["7"].append({**table["7"][0], "obj_id": 4})
    (tmp_path / "scene_gt.json").write_text(json.dumps(table))
    with pytest.raises(InputError, match="expected one object"):
        read_bop(tmp_path)
    (found,) = read_bop(tmp_path, 3)
    assert found.T_camera_target[:3, 3].tolist() == [0.01, -0.02, 1.5]
    assert np.allclose(found.T_camera_target[:3, :3] @ found.T_camera_target[:3, :3].T, np.eye(3), atol=1e-12)


ROTATION = '{"1": [{"obj_id": 1, "cam_R_m2c": %s, "cam_t_m2c": [0, 0, 0]}]}'


@pytest.mark.parametrize(
    "broken",
    ["", "[]", "{}", '{"x": []}', '{"1": 5}', ROTATION % "[1]", ROTATION % "[2, 0, 0, 0, 1, 0, 0, 0, 1]"],
)
def test_a_broken_scene_is_one_line(broken: str, tmp_path: Path) -> None:
    write_bop(tmp_path, [BopFrame(frame=1, K=np.eye(3), T_camera_target=np.eye(4))])
    (tmp_path / "scene_gt.json").write_text(broken)
    with pytest.raises(InputError, match=r"scene_gt\.json") as raised:
        read_bop(tmp_path)
    assert "\n" not in str(raised.value)


def test_flights_keep_their_speed_and_shape(frigate: Shipped) -> None:
    middle = 0.5 * (frigate.target.positions.min(axis=0) + frigate.target.positions.max(axis=0))
    counts: dict[str, int] = {}
    for name in FLIGHTS:
        placed = fly(name, frigate.target, stride=5)
        eyes = np.array([-p.T_camera_target[:3, :3].T @ p.T_camera_target[:3, 3] for p in placed])
        speeds = np.linalg.norm(np.diff(eyes, axis=0), axis=1) / 0.2
        assert np.ptp(speeds) < 0.02 * speeds.mean(), name
        counts[name] = len(placed)
        ranges = np.linalg.norm(eyes - middle, axis=1)
        if name == "orbit-2.0":
            assert np.allclose(ranges, 2000.0)
            assert speeds.mean() == pytest.approx(60.0, rel=1e-3)
        elif name.startswith("rendezvous"):
            assert ranges[0] == pytest.approx(2000.0)
            assert ranges[-1] == pytest.approx(500.0, abs=10.0)
            azimuths = np.unwrap(np.arctan2(*(eyes - middle).T[1::-1]))
            assert np.degrees(abs(azimuths[-1] - azimuths[0])) == pytest.approx(float(name[-2:]), abs=0.3)
            assert speeds.mean() == pytest.approx(40.0, rel=1e-3)
    assert min(counts.values()) >= 150


def test_swell_moves_the_target_in_the_world_and_in_the_camera_alike(frigate: Shipped) -> None:
    still, moved = (fly("landing", frigate.target, stride=25, swell=swell)[2] for swell in (None, Swell()))
    T_camera_world = [p.T_camera_target @ geometry.inverse(p.T_world_target) for p in (still, moved)]
    assert np.allclose(*T_camera_world, atol=1e-9)
    assert not np.allclose(still.T_camera_target, moved.T_camera_target, atol=1e-3)


def test_crops_keep_pixel_centres() -> None:
    """The corner of the crop is u' = -1/2; its middle stays its middle."""
    camera = pinhole(1024, 1910.0)
    crop = crop_camera(camera, np.array([99.5, 199.5]), 64.0, 256)
    rays = np.array([[(99.5 - 511.5) / 1910.0, (199.5 - 511.5) / 1910.0, 1.0], [(131.5 - 511.5) / 1910.0, 0.0, 1.0]])
    pixels = geometry.project(crop, rays)
    assert np.allclose(pixels[0], [-0.5, -0.5])
    assert pixels[1, 0] == pytest.approx(127.5)


AROUND = {
    "frigate": [],
    "satellite": ["--surroundings", "space"],
    "marker_pen": ["--surroundings", "room", "--up", "0", "-1", "0"],
}


@pytest.mark.parametrize("name", AROUND)
def test_crops_are_labelled(name: str, graphics: None, repository: Path, shipped: Callable, tmp_path: Path) -> None:
    target = repository / "data" / name / "target.toml"
    arguments = ["render", "crops", "--target", str(target), "--count", "6", "--size", "64", *AROUND[name]]
    for folder in ("one", "two"):
        assert main([*arguments, "-o", str(tmp_path / folder)]) == 0
    names, labels = read_coco(tmp_path / "one" / "annotations.json")
    assert names == shipped(name).target.landmarks
    assert len(labels) == 6
    assert (tmp_path / "one" / "annotations.json").read_text() == (tmp_path / "two" / "annotations.json").read_text()
    for label in labels:
        first, second = ((tmp_path / folder / label.file_name).read_bytes() for folder in ("one", "two"))
        assert first == second
        visible = np.array(label.visibility)
        assert set(visible.tolist()) <= {0, 1, 2}
        inside = label.pixels[visible > 0]
        assert (inside >= -0.5).all()
        assert (inside <= 63.5).all()
        # The varied shape differs from the drawing by some percent of the size of the target.
        camera = replace(pinhole(64, 1.0), K=label.K)
        drawn = geometry.project(camera, geometry.transform(label.T_camera_target, shipped(name).target.positions))
        assert np.median(np.abs(drawn[visible > 0] - inside)) < 12.0
    pictures = [read_image(tmp_path / "one" / label.file_name).astype(float) for label in labels]
    assert np.std([picture.mean() for picture in pictures]) > 1.0


def test_crops_without_the_target_label_nothing(graphics: None, repository: Path, tmp_path: Path) -> None:
    target = str(repository / "data" / "frigate" / "target.toml")
    arguments = ["render", "crops", "--target", target, "--count", "4", "--size", "64"]
    for share in ("0", "1"):
        assert main([*arguments, "--empty", share, "-o", str(tmp_path / share)]) == 0
    (_, with_it), (_, without) = (read_coco(tmp_path / share / "annotations.json") for share in ("0", "1"))
    assert all(max(label.visibility) > 0 for label in with_it)
    for label in without:
        assert set(label.visibility) == {0}
        assert not label.pixels.any()
        assert geometry.transform(label.T_camera_target, np.zeros((1, 3)))[0, 2] < 0.0
    for label in with_it:
        there, gone = (read_image(tmp_path / share / label.file_name).astype(float) for share in "01")
        assert np.abs(there - gone).max() > 20.0


def without_mesh(target: Path, path: Path) -> Path:
    lines = [line for line in target.read_text().splitlines() if not line.startswith("mesh")]
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["nonsense"], "expected orbit-2.0"),
        (["crops", "--target", "{bare}"], "names no mesh"),
        (["nowhere/truth.csv"], "nowhere/truth.csv"),
        (["landing", "--target", "{frigate}", "--first", "900"], "the last frame is 810"),
    ],
)
def test_what_cannot_be_rendered_is_one_line_and_2(
    arguments: list[str], message: str, repository: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    frigate = str(repository / "data" / "frigate" / "target.toml")
    bare = str(without_mesh(Path(frigate), tmp_path / "bare.toml"))
    told = [{"{bare}": bare, "{frigate}": frigate}.get(a, a) for a in arguments]
    camera = ["--camera", str(repository / "data" / "frigate" / "camera.yaml")]
    assert main(["render", *told, *camera, "-o", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
