# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Real photographs through a detector: as long as they last, and what happens when one is broken."""

import shutil
import struct
import zlib
from pathlib import Path

import pytest

from fairlead.cli import main
from fairlead.io.observations import read_views
from fairlead.io.poses import read_poses
from fairlead.io.shipped import shipped_data


def arguments(pen: Path, images: Path, out: Path, *more: str) -> list[str]:
    files = ["--target", str(pen / "target.toml"), "--camera", str(pen / "camera.yaml"), "-o", str(out)]
    return ["track", str(images), "--detector", "aruco:DICT_4X4_100", *files, *more]


def test_photographs_give_poses(marker_pen: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments(marker_pen, marker_pen / "images", tmp_path)) == 0
    assert capsys.readouterr().err == ""
    views = list(read_views(tmp_path / "observations.csv"))
    assert len(views) == 16
    assert sum(len(view.landmarks) for view in views) >= 200
    assert [view.stamp_ns for view in views] == sorted(view.stamp_ns for view in views)
    assert views[0].stamp_ns == 1_689_478_371_000_000_000
    assert all(estimate.ok for estimate in read_poses(tmp_path / "poses.csv"))


@pytest.mark.parametrize("broken", [b"", b"\xff\xd8\xff", b"GIF89a"])
def test_a_broken_photograph_keeps_what_was_computed(
    marker_pen: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], broken: bytes
) -> None:
    images = tmp_path / "images"
    images.mkdir()
    for path in sorted((marker_pen / "images").iterdir())[:3]:
        shutil.copy(path, images)
    (images / "1689478999.jpg").write_bytes(broken)
    assert main(arguments(marker_pen, images, tmp_path / "run")) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "1689478999.jpg" in error
    assert len(read_poses(tmp_path / "run" / "poses.csv")) == 3


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (("--detector", "aruco:DICT_9X9"), "--detector"),
        (("--detector", "apriltag"), "expected one of"),
        (("--camera", "{temple}/camera.yaml"), "expected 640 x 480 as the camera has, got an image of 1920 x 1080"),
        (("--target", "{temple}/target.toml"), "expected a target with landmarks named tag"),
    ],
)
def test_a_detector_that_does_not_fit_is_one_line_and_2(
    marker_pen: Path,
    temple_ring: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    more: tuple[str, str],
    message: str,
) -> None:
    words = [word.format(temple=temple_ring) for word in more]
    assert main(arguments(marker_pen, marker_pen / "images", tmp_path / "run", *words)) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert message in error
    assert not (tmp_path / "run").exists()


def test_a_gigantic_header_and_a_name_that_leaves_the_folder_are_one_line_and_2(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    images = tmp_path / "images"
    images.mkdir()
    header = b"IHDR" + struct.pack(">IIBBBBB", 60_000, 60_000, 8, 2, 0, 0, 0)
    chunk = struct.pack(">I", 13) + header + struct.pack(">I", zlib.crc32(header))
    end = struct.pack(">I", 0) + b"IEND" + struct.pack(">I", zlib.crc32(b"IEND"))
    (images / "1689478371.png").write_bytes(b"\x89PNG\r\n\x1a\n" + chunk + end)
    pen = shipped_data("marker_pen")
    assert main(arguments(pen, images, tmp_path / "run")) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "60000 x 60000" in error
    (images / "stamps.csv").write_text("image,stamp_ns\n../../secret.png,1\n")
    assert main(arguments(pen, images, tmp_path / "run")) == 2
    assert "not there" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()
