# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Where frames come from: order, stamps, size, and folders that are not left."""

import struct
import zlib
from pathlib import Path

import numpy as np
import pytest

from fairlead.io.errors import InputError
from fairlead.sources.image_folder import ImageFolderSource, stamp_of_name
from fairlead.sources.table import TableSource
from fairlead.types import Camera

HEADER = "frame,stamp_ns,landmark,u_px,v_px,var_u,cov_uv,var_v\n"


def camera(width: int = 6, height: int = 4) -> Camera:
    K = np.array([[5.0, 0.0, 3.0], [0.0, 5.0, 2.0], [0.0, 0.0, 1.0]])
    return Camera(name="c", width=width, height=height, model="pinhole", K=K, distortion=np.zeros(0))


def write_png(path: Path, value: int = 0, width: int = 6, height: int = 4) -> None:
    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    rows = (b"\0" + bytes([value]) * width) * min(height, 100)
    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    content = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + content)


def test_images_come_in_the_order_of_their_names(tmp_path: Path) -> None:
    for value, name in [(3, "c.png"), (1, "a.png"), (2, "b.PNG")]:
        write_png(tmp_path / name, value)
    (tmp_path / "notes.txt").write_text("no image")
    source = ImageFolderSource(tmp_path, camera(), fps=4.0)
    frames = list(source)
    assert source.count() == 3
    assert [frame.image[0, 0, 0] for frame in frames] == [1, 2, 3]
    assert [(frame.frame, frame.stamp_ns) for frame in frames] == [(0, 0), (1, 250_000_000), (2, 500_000_000)]
    assert frames[0].image.shape == (4, 6, 3)


@pytest.mark.parametrize(
    ("stem", "stamp_ns"),
    [
        ("1689478371", 1_689_478_371_000_000_000),
        ("1305031102.175304", 1_305_031_102_175_304_000),
        ("1689478371123456789", 1_689_478_371_123_456_789),
        ("000012", None),
        ("frame_1689478371", None),
        ("9999999999999999999", None),
        ("", None),
        ("١٦٨٩٤٧٨٣٧١", None),
    ],
)
def test_stamps_of_names(stem: str, stamp_ns: int | None) -> None:
    assert stamp_of_name(stem) == stamp_ns


def test_stamps_come_from_names_or_from_a_table(tmp_path: Path) -> None:
    write_png(tmp_path / "1689478372.png")
    write_png(tmp_path / "1689478371.png")
    assert [frame.stamp_ns for frame in ImageFolderSource(tmp_path, camera())] == [
        1_689_478_371_000_000_000,
        1_689_478_372_000_000_000,
    ]
    (tmp_path / "stamps.csv").write_text("image,stamp_ns\n1689478372.png,5\n")
    assert [frame.stamp_ns for frame in ImageFolderSource(tmp_path, camera())] == [5]


def test_a_folder_without_stamps_asks_for_fps(tmp_path: Path) -> None:
    write_png(tmp_path / "a.png")
    with pytest.raises(InputError, match="give --fps"):
        ImageFolderSource(tmp_path, camera())
    with pytest.raises(ValueError, match="fps"):
        ImageFolderSource(tmp_path, camera(), fps=0.0)


def test_an_empty_folder_and_an_empty_table_of_stamps(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no image"):
        ImageFolderSource(tmp_path, camera(), fps=1.0)
    (tmp_path / "stamps.csv").write_text("image,stamp_ns\n")
    with pytest.raises(InputError, match="names no image"):
        ImageFolderSource(tmp_path, camera(), fps=1.0)


def test_images_stay_under_their_folder(tmp_path: Path) -> None:
    folder = tmp_path / "images"
    folder.mkdir()
    write_png(tmp_path / "secret.png")
    (folder / "stamps.csv").write_text("image,stamp_ns\n../secret.png,5\n")
    with pytest.raises(InputError, match=r"stamps\.csv: names a file outside its folder: '\.\./secret\.png'"):
        ImageFolderSource(folder, camera(), fps=1.0)
    (folder / "stamps.csv").unlink()
    (folder / "link.png").symlink_to(tmp_path / "secret.png")
    with pytest.raises(InputError, match="outside its folder"):
        ImageFolderSource(folder, camera(), fps=1.0)
    (folder / "link.png").unlink()
    (folder / "dangling.png").symlink_to(tmp_path / "none.png")
    with pytest.raises(InputError, match="not there"):
        ImageFolderSource(folder, camera(), fps=1.0)
    inside = tmp_path / "link_to_folder"  # the folder itself may be a link
    (folder / "dangling.png").unlink()
    write_png(folder / "a.png")
    inside.symlink_to(folder)
    assert ImageFolderSource(inside, camera(), fps=1.0).count() == 1


def test_an_image_of_another_size_than_the_camera_is_an_error(tmp_path: Path) -> None:
    write_png(tmp_path / "a.png", width=4, height=6)
    with pytest.raises(InputError, match=r"a\.png: expected 6 x 4 as the camera has, got an image of 4 x 6"):
        list(ImageFolderSource(tmp_path, camera(), fps=1.0))


def test_a_gigantic_image_is_refused_by_its_header(tmp_path: Path) -> None:
    write_png(tmp_path / "a.png", width=60_000, height=60_000)
    with pytest.raises(InputError, match="60000 x 60000"):
        list(ImageFolderSource(tmp_path, camera(60_000, 60_000), fps=1.0))


@pytest.mark.parametrize("content", [b"", b"\x89PNG\r\n\x1a\n", b"GIF89a", b"\xff\xd8\xff\xe0"])
def test_what_is_no_image(tmp_path: Path, content: bytes) -> None:
    write_png(tmp_path / "a.png")
    (tmp_path / "b.png").write_bytes(content)
    frames = iter(ImageFolderSource(tmp_path, camera(), fps=1.0))
    assert next(frames).frame == 0
    with pytest.raises(InputError, match=r"b\.png"):
        next(frames)


def test_a_table_names_landmarks_of_the_target(tmp_path: Path) -> None:
    path = tmp_path / "o.csv"
    path.write_text(f"{HEADER}0,0,bow,1,2,1,0,1\n0,0,mast,1,2,1,0,1\n1,1,,,,,,\n2,2,bwo,1,2,1,0,1\n")
    source = TableSource(path, ("bow", "mast"))
    assert source.count() == 4
    views = iter(source)
    assert [source.work(view) for view in (next(views), next(views))] == [2, 1]
    with pytest.raises(InputError, match=r"frame 2: the target has no landmark 'bwo'; did you mean 'bow'\?"):
        next(views)
