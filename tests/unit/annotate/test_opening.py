# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What `fairlead annotate DIR` finds in a folder, and what it says where something lacks."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from fairlead.io.errors import InputError
from fairlead.opencv.filters import write_image
from fairlead.prepare import load_project
from fairlead.target_config import AnnotateConfig


def settled(folder: Path, **changes: object) -> list[tuple[int, int]]:
    """Number and stamp of the frames."""
    project = load_project(AnnotateConfig(folder=folder, **changes))  # pyright: ignore[reportArgumentType]
    project.journal.close()
    return [(frame.number, frame.stamp_ns) for frame in project.frames]


def test_mesh_camera_and_images_are_found(repository: Path, tmp_path: Path) -> None:
    for name in ("satellite.ply", "camera.yaml"):
        shutil.copy(repository / "data" / "satellite" / name, tmp_path)
    (tmp_path / "images").mkdir()
    for k in range(3):
        write_image(tmp_path / "images" / f"{k}.png", np.zeros((4, 4, 3), np.uint8))
    assert settled(tmp_path) == [(0, 0), (1, 10**9), (2, 2 * 10**9)]
    assert settled(tmp_path, fps=10.0)[1] == (1, 10**8)


def test_the_frames_of_a_video_are_written_once(repository: Path, tmp_path: Path) -> None:
    av = pytest.importorskip("av")
    text = (repository / "data" / "satellite" / "camera.yaml").read_text()
    (tmp_path / "camera.yaml").write_text(text.replace("1024", "64").replace("511.5", "31.5"))
    with av.open(str(tmp_path / "clip.mkv"), "w") as container:
        stream = container.add_stream("ffv1", rate=10)
        stream.width = stream.height = 64
        stream.pix_fmt = "bgr0"
        for k in range(5):
            image = np.full((64, 64, 3), 40 * k, np.uint8)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="bgr24")))
        container.mux(stream.encode())
    clip = {"images": tmp_path / "clip.mkv", "every": 2}
    frames = settled(tmp_path, **clip)
    assert [stamp for _, stamp in frames] == [0, 2 * 10**8, 4 * 10**8]
    assert len(list((tmp_path / "images").glob("*.png"))) == 3
    (tmp_path / "clip.mkv").unlink()
    assert settled(tmp_path) == frames


def test_what_lacks_is_said_and_no_labels_are_begun(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="found none"):
        settled(tmp_path)
    (tmp_path / "images").mkdir()
    write_image(tmp_path / "images" / "0.png", np.zeros((4, 4, 3), np.uint8))
    with pytest.raises(InputError, match=r"holds images and no camera\.yaml"):
        settled(tmp_path)
    for name in ("a.stl", "b.stl"):
        (tmp_path / name).write_bytes(b"")
    with pytest.raises(InputError, match=r"holds 2 meshes \(a\.stl, b\.stl\): say which with --mesh"):
        settled(tmp_path)
    with pytest.raises(InputError, match="expected a folder"):
        settled(tmp_path / "none")
    assert not (tmp_path / "labels.jsonl").exists()
