# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What is written is read back; whatever is read gives a record or one line, never another exception."""

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from fairlead.geometry import exp_se3
from fairlead.io.camera import load_camera, save_camera
from fairlead.io.errors import InputError
from fairlead.io.observations import read_views, write_views
from fairlead.io.options import load_options
from fairlead.io.poses import read_poses, read_truth, write_poses, write_truth
from fairlead.io.run_record import RunRecord, read_run_record, write_run_record
from fairlead.io.target import load_target, save_target
from fairlead.io.timing import read_timing
from fairlead.types import Camera, Estimate, KnownDistance, MotionPrior, Target, TruthPose, View

# Cs: surrogates cannot be written; "\r" alone is kept by csv but is no name anybody can type
names = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\r\x00"), min_size=1, max_size=12).filter(
    lambda name: bool(name.strip())
)
stamps = st.integers(-(2**63), 2**63 - 1)
numbers = st.floats(width=64)
finite = st.floats(-1e6, 1e6, allow_subnormal=False)


@st.composite
def view_fields(draw: st.DrawFn, frame: int) -> dict[str, Any]:  # records are made outside: beartype draws at random
    landmarks = tuple(draw(st.lists(names, max_size=4)))
    n = len(landmarks)
    upper = draw(arrays(np.float64, (n, 3), elements=numbers))
    scores = draw(st.none() | arrays(np.float64, n, elements=finite)) if n else None
    return {
        "frame": frame,
        "stamp_ns": draw(stamps),
        "landmarks": landmarks,
        "pixels": draw(arrays(np.float64, (n, 2), elements=numbers)),
        "covariances": upper[:, [0, 1, 1, 2]].reshape(n, 2, 2),
        "scores": scores,
    }


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
@given(st.data())
def test_views_come_back(suffix: str, data: st.DataObject) -> None:
    frames = data.draw(st.lists(stamps, unique=True, max_size=3))
    written = [View(**data.draw(view_fields(frame))) for frame in frames]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"observations{suffix}"
        write_views(path, written, with_scores=True)
        again = list(read_views(path))
    assert len(again) == len(written)
    for before, after in zip(written, again, strict=True):
        assert (before.frame, before.stamp_ns, before.landmarks) == (after.frame, after.stamp_ns, after.landmarks)
        assert np.array_equal(before.pixels, after.pixels, equal_nan=True)
        assert np.array_equal(before.covariances, after.covariances, equal_nan=True)
        assert (before.scores is None) == (after.scores is None)
        if before.scores is not None and after.scores is not None:
            assert np.array_equal(before.scores, after.scores)


@st.composite
def target_fields(draw: st.DrawFn) -> dict[str, Any]:
    landmarks = tuple(draw(st.lists(names, min_size=2, max_size=5, unique=True)))
    n = len(landmarks)
    root = draw(arrays(np.float64, (3 * n, 3), elements=st.floats(-10.0, 10.0)))
    return {
        "name": draw(names),
        "landmarks": landmarks,
        "positions": draw(arrays(np.float64, (n, 3), elements=finite)),
        "covariance": root @ root.T,
        "touchdown": draw(st.none() | arrays(np.float64, 3, elements=finite)),
        "distances": draw(st.none() | st.floats(0.1, 1e6)),
        "motion": draw(st.none() | st.floats(0.0, 1e9)),
    }


@given(target_fields())
def test_targets_come_back(fields: dict[str, Any]) -> None:
    length_m, density = fields.pop("distances"), fields.pop("motion")
    between = fields["landmarks"][:2]
    target = Target(
        **fields,
        distances=() if length_m is None else (KnownDistance(between=between, length_m=length_m, sigma_m=0.5),),
        motion=None if density is None else MotionPrior(kind="world", jerk_density_m_s25=density),
    )
    with tempfile.TemporaryDirectory() as folder:
        save_target(Path(folder) / "target.toml", target)
        again = load_target(Path(folder) / "target.toml")
    assert again.name == target.name
    assert again.landmarks == target.landmarks
    assert np.array_equal(again.positions, target.positions)
    assert np.array_equal(again.covariance, target.covariance)
    assert again.distances == target.distances
    assert again.motion == target.motion
    assert (again.touchdown is None) == (target.touchdown is None)


@given(st.data())
def test_estimates_and_truth_come_back(data: st.DataObject) -> None:
    xi = data.draw(arrays(np.float64, 6, elements=st.floats(-3.0, 3.0, allow_subnormal=False)))
    root = data.draw(arrays(np.float64, (6, 6), elements=st.floats(-3.0, 3.0, allow_subnormal=False)))
    estimate = Estimate(
        frame=data.draw(stamps),
        stamp_ns=data.draw(stamps),
        status=data.draw(st.sampled_from(["tracking", "coasting"])),
        reason=data.draw(names),
        T_camera_target=exp_se3(xi),
        covariance=root @ root.T + 1e-6 * np.eye(6),
        n_inliers=data.draw(st.integers(0, 100)),
        reprojection_rms_px=data.draw(st.floats(0.0, 1e6)),
        information_gained=0.0,
        reset_counter=0,
        inliers=(),
    )
    with tempfile.TemporaryDirectory() as folder:
        write_poses(Path(folder) / "poses.csv", [estimate])
        (again,) = read_poses(Path(folder) / "poses.csv")
        write_truth(Path(folder) / "truth.csv", [TruthPose(frame=1, stamp_ns=2, T_camera_target=exp_se3(xi))])
        (truth,) = read_truth(Path(folder) / "truth.csv")
    assert (again.frame, again.stamp_ns, again.status) == (estimate.frame, estimate.stamp_ns, estimate.status)
    assert (again.n_inliers, again.reprojection_rms_px) == (estimate.n_inliers, estimate.reprojection_rms_px)
    assert np.allclose(again.T_camera_target, estimate.T_camera_target, rtol=0.0, atol=1e-14)
    assert np.array_equal(truth.T_camera_target, again.T_camera_target)
    # only the upper triangle is in the file; root @ root.T is symmetric to the last bit or two
    assert np.allclose(again.covariance, estimate.covariance, rtol=1e-15, atol=1e-15)


def _files(folder: Path) -> list[tuple[str, Callable[[Path], object]]]:
    """One good file of each kind, and its reader."""
    rng = np.random.default_rng(5)
    target = Target(
        name="t", landmarks=("a", "b"), positions=rng.normal(size=(2, 3)), covariance=np.diag(rng.uniform(size=6))
    )
    save_target(folder / "target.toml", target)
    K = np.array([[500.0, 0.0, 320.0], [0.0, 500.0, 240.0], [0.0, 0.0, 1.0]])
    camera = Camera(name="c", width=640, height=480, model="plumb_bob", K=K, distortion=np.zeros(5))
    save_camera(folder / "camera.yaml", camera)
    (folder / "opencv.yml").write_text(
        "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n"
        "   dt: d\n   data: [ 500., 0., 320., 0., 500., 240., 0., 0., 1. ]\n"
    )
    (folder / "kalibr.yaml").write_text(
        "cam0:\n  camera_model: pinhole\n  distortion_coeffs: [0.1, 0.2, 0, 0]\n  distortion_model: radtan\n"
        "  intrinsics: [500.0, 510.0, 320.5, 240.5]\n  resolution: [640, 480]\n"
    )
    (folder / "cameras.txt").write_text("1 OPENCV 640 480 500 510 321 241 -0.1 0.02 0.001 -0.001\n")
    view = View(
        frame=0,
        stamp_ns=1,
        landmarks=("a", "b"),
        pixels=rng.normal(size=(2, 2)),
        covariances=np.tile(np.eye(2), (2, 1, 1)),
    )
    write_views(folder / "observations.csv", [view])
    write_views(folder / "observations.parquet", [view])
    write_truth(folder / "truth.csv", [TruthPose(frame=0, stamp_ns=0, T_camera_target=np.eye(4))])
    estimate = Estimate(
        frame=0,
        stamp_ns=0,
        status="tracking",
        reason="",
        T_camera_target=np.eye(4),
        covariance=np.eye(6),
        n_inliers=4,
        reprojection_rms_px=1.0,
        information_gained=0.0,
        reset_counter=0,
        inliers=(),
    )
    write_poses(folder / "poses.csv", [estimate])
    write_run_record(folder / "run.json", RunRecord(command="track", state="done", options=None, inputs=()))
    (folder / "timing.csv").write_text("frame,stamp_ns,detect_ms,update_ms\n0,1,2.5,3.5\n")
    (folder / "options.toml").write_text('kind = "target"\njerk_density_m_s25 = 0.5\n')
    return [
        ("target.toml", load_target),
        ("target.npz", lambda path: load_target(path.with_suffix(".toml"))),
        ("camera.yaml", load_camera),
        ("opencv.yml", load_camera),
        ("kalibr.yaml", load_camera),
        ("cameras.txt", load_camera),
        ("observations.csv", lambda path: list(read_views(path))),
        ("observations.parquet", lambda path: list(read_views(path))),
        ("truth.csv", read_truth),
        ("poses.csv", read_poses),
        ("run.json", read_run_record),
        ("timing.csv", read_timing),
        ("options.toml", lambda path: load_options(path, MotionPrior(kind="none", jerk_density_m_s25=0.0))),
    ]


@pytest.fixture(scope="module")
def good_files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[bytes, Path, Callable[[Path], object]]]:
    folder = tmp_path_factory.mktemp("good")
    files = {name: ((folder / name).read_bytes(), folder / name, reader) for name, reader in _files(folder)}
    for _, path, reader in files.values():
        reader(path)
    return files


NAMES = (
    *("target.toml", "target.npz", "camera.yaml", "opencv.yml", "kalibr.yaml", "cameras.txt", "observations.csv"),
    *("observations.parquet", "truth.csv", "poses.csv", "run.json", "timing.csv", "options.toml"),
)


def _one_line_about(error: InputError, path: Path) -> None:
    assert "\n" not in str(error)
    assert str(path.parent) in str(error)


@pytest.mark.parametrize("name", NAMES)
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    edits=st.lists(st.tuples(st.integers(0, 10**6), st.binary(max_size=6), st.integers(0, 12)), min_size=1, max_size=4)
)
@example(edits=[(0, b"", 0)])
def test_mutated_files_give_a_record_or_one_line(
    name: str,
    edits: list[tuple[int, bytes, int]],
    good_files: dict[str, tuple[bytes, Path, Callable[[Path], object]]],
) -> None:
    """Bytes are replaced, put in and taken out at any place."""
    good, path, reader = good_files[name]
    data = good
    for place, put_in, take_out in edits:
        start = place % (len(data) + 1)
        data = data[:start] + put_in + data[start + take_out :]
    path.write_bytes(data)
    try:
        reader(path)
    except InputError as error:
        _one_line_about(error, path)
    finally:
        path.write_bytes(good)


@pytest.mark.parametrize("name", NAMES)
def test_truncated_files_give_a_record_or_one_line(
    name: str, good_files: dict[str, tuple[bytes, Path, Callable[[Path], object]]]
) -> None:
    good, path, reader = good_files[name]
    try:
        for cut in range(0, len(good), max(1, len(good) // 60)):
            path.write_bytes(good[:cut])
            try:
                reader(path)
            except InputError as error:
                _one_line_about(error, path)
    finally:
        path.write_bytes(good)
