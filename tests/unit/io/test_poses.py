# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""poses.csv, truth.csv, trajectory.tum, timing.csv: exact where they are right, one line where they are not."""

import logging
import math
from pathlib import Path

import numpy as np
import pytest

from fairlead.geometry import exp_se3
from fairlead.io.errors import InputError
from fairlead.io.poses import COLUMNS, read_poses, read_truth, write_poses, write_truth
from fairlead.io.timing import Timing, read_timing
from fairlead.io.tum import write_trajectory_tum
from fairlead.sinks.csv import TimingSink
from fairlead.types import Estimate, TruthPose

T = exp_se3(np.array([1.0, -2.0, 30.0, 0.3, -0.8, 0.5]))
NOTHING = np.full((4, 4), np.nan)


def make_estimate(frame: int, status: str = "tracking", reason: str = "") -> Estimate:
    ok = status in ("tracking", "coasting")
    root = np.arange(36.0).reshape(6, 6) / 7.0
    return Estimate(
        frame=frame,
        stamp_ns=1_689_478_371_000_000_000 + frame,
        status=status,  # pyright: ignore[reportArgumentType]
        reason=reason,
        T_camera_target=T if ok else NOTHING,
        covariance=root @ root.T + np.eye(6) if ok else np.full((6, 6), np.nan),
        n_inliers=frame,
        reprojection_rms_px=1.0 / 3.0 if ok else math.nan,
        information_gained=0.5,
        reset_counter=2,
        inliers=("a",),
    )


def test_header_is_the_file_contract(tmp_path: Path) -> None:
    write_poses(tmp_path / "poses.csv", [])
    upper = ",".join(f"c{i}{j}" for i in range(6) for j in range(i, 6))
    expected = f"frame,stamp_ns,tx,ty,tz,qx,qy,qz,qw,status,reason,{upper},n_inliers,reprojection_rms_px\n"
    assert (tmp_path / "poses.csv").read_text() == expected
    assert len(COLUMNS) == 9 + 2 + 21 + 2


def test_estimates_come_back(tmp_path: Path) -> None:
    estimates = [make_estimate(0, "acquiring", "too_few"), make_estimate(1), make_estimate(2, "coasting", "gated")]
    write_poses(tmp_path / "poses.csv", estimates)
    lines = (tmp_path / "poses.csv").read_text().splitlines()
    assert lines[1] == "0,1689478371000000000,,,,,,,,acquiring,too_few" + "," * 21 + ",0,"
    again = read_poses(tmp_path / "poses.csv")
    assert [estimate.status for estimate in again] == ["acquiring", "tracking", "coasting"]
    assert [estimate.reason for estimate in again] == ["too_few", "", "gated"]
    assert [estimate.stamp_ns for estimate in again] == [estimate.stamp_ns for estimate in estimates]
    assert np.isnan(again[0].T_camera_target).all()
    for estimate in again[1:]:
        assert np.allclose(estimate.T_camera_target, T, atol=1e-15, rtol=1e-15)
        assert np.array_equal(estimate.covariance, estimates[1].covariance)
    assert again[1].reprojection_rms_px == 1.0 / 3.0
    assert math.isnan(again[0].reprojection_rms_px)


def test_truth_is_the_first_nine_columns_of_poses(tmp_path: Path) -> None:
    write_truth(tmp_path / "truth.csv", [TruthPose(frame=4, stamp_ns=5, T_camera_target=T)])
    (pose,) = read_truth(tmp_path / "truth.csv")
    assert (pose.frame, pose.stamp_ns) == (4, 5)
    assert np.allclose(pose.T_camera_target, T, atol=1e-15)
    write_poses(tmp_path / "poses.csv", [make_estimate(0, "lost"), make_estimate(1)])
    assert [pose.frame for pose in read_truth(tmp_path / "poses.csv")] == [1]


def test_the_given_truth_of_the_temple(temple_ring: Path) -> None:
    truth = read_truth(temple_ring / "truth.csv")
    assert len(truth) == 16
    assert truth[0].T_camera_target[:3, 3].tolist() == [-0.0193474918165, 0.04321050765, 0.589790751867]


@pytest.mark.parametrize(
    ("cells", "message"),
    [
        ("0,1,1,2,3,0,0,0,2", ":2: qx,qy,qz,qw: expected a unit quaternion, got one of norm 2"),
        ("0,1,1,2,3,0,0,0,0", ":2: qx,qy,qz,qw: expected a unit quaternion"),
        ("0,1,1,2,,0,0,0,1", ":2: tx,ty,tz,qx,qy,qz,qw: expected finite numbers or seven empty cells"),
        ("0,1,1,2,inf,0,0,0,1", ":2: tx,ty,tz,qx,qy,qz,qw: expected finite numbers"),
        ("0,1,1,2,3,0,0,1", ":2: expected 9 cells, got 8"),
        ("0,now,1,2,3,0,0,0,1", ":2: stamp_ns: expected a whole number"),
    ],
)
def test_wrong_truth(tmp_path: Path, cells: str, message: str) -> None:
    path = tmp_path / "truth.csv"
    path.write_text(f"frame,stamp_ns,tx,ty,tz,qx,qy,qz,qw\n{cells}\n")
    with pytest.raises(InputError) as caught:
        read_truth(path)
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("column", "value", "message"),
    [
        ("status", "dreaming", "status: expected one of acquiring"),
        ("status", "lost", "expected NaN pose and covariance"),
        ("c00", "-1", "positive semidefinite"),
        ("c00", "", "positive semidefinite"),
        ("n_inliers", "", "n_inliers: expected a whole number"),
        ("tx", "", "seven empty cells"),
    ],
)
def test_wrong_poses(tmp_path: Path, column: str, value: str, message: str) -> None:
    path = tmp_path / "poses.csv"
    write_poses(path, [make_estimate(0), make_estimate(1)])
    lines = path.read_text().splitlines()
    cells = lines[2].split(",")
    cells[COLUMNS.index(column)] = value
    path.write_text("\n".join([*lines[:2], ",".join(cells)]) + "\n")
    with pytest.raises(InputError) as caught:
        read_poses(path)
    assert ":3: " in str(caught.value)
    assert message in str(caught.value)


def test_a_torn_last_line_is_left_out_with_a_warning(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = tmp_path / "poses.csv"
    write_poses(path, [make_estimate(frame) for frame in range(3)])
    whole = path.read_bytes()
    second = whole.index(b"\n2,")
    with caplog.at_level(logging.WARNING):
        for cut in range(second + 2, len(whole) - 30, 7):
            path.write_bytes(whole[:cut])
            assert [estimate.frame for estimate in read_poses(path)] == [0, 1]
    assert "torn" in caplog.text
    path.write_bytes(whole[:40] + b"\n" + whole[40:])  # torn elsewhere is an error
    with pytest.raises(InputError):
        read_poses(path)


def test_tum_is_the_camera_in_the_target_frame(tmp_path: Path) -> None:
    T_camera_target = np.eye(4)
    T_camera_target[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    T_camera_target[:3, 3] = [1.0, 2.0, 3.0]
    poses = [
        TruthPose(frame=0, stamp_ns=1_689_478_371_000_000_001, T_camera_target=T_camera_target),
        make_estimate(1, "lost"),
        TruthPose(frame=2, stamp_ns=-1, T_camera_target=np.eye(4)),
    ]
    write_trajectory_tum(tmp_path / "t.tum", poses)
    first, second = (tmp_path / "t.tum").read_text().splitlines()
    stamp, *cells = first.split(" ")
    assert stamp == "1689478371.000000001"
    half = math.sqrt(0.5)
    assert np.allclose([float(cell) for cell in cells], [-2.0, 1.0, -3.0, 0.0, 0.0, -half, half])
    assert second.startswith("-0.000000001 ")


def test_tum_is_what_evo_reads(tmp_path: Path) -> None:
    file_interface = pytest.importorskip("evo.tools.file_interface")
    write_trajectory_tum(tmp_path / "t.tum", [make_estimate(frame) for frame in range(3)])
    trajectory = file_interface.read_tum_trajectory_file(str(tmp_path / "t.tum"))
    assert np.allclose(trajectory.poses_se3[0], np.linalg.inv(T))


def test_timing_comes_back(tmp_path: Path) -> None:
    sink = TimingSink(tmp_path / "timing.csv")
    sink.write(Timing(frame=3, stamp_ns=4, detect_ms=1.25, update_ms=math.nan))
    sink.close()
    sink.close()
    (timing,) = read_timing(tmp_path / "timing.csv")
    assert (timing.frame, timing.stamp_ns, timing.detect_ms) == (3, 4, 1.25)
    assert math.isnan(timing.update_ms)
