# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables of observations: streamed, grouped by frame, wrong rows named by line."""

from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from fairlead.io.errors import InputError
from fairlead.io.observations import count_observations, read_views, write_views
from fairlead.types import View

HEADER = "frame,stamp_ns,landmark,u_px,v_px,var_u,cov_uv,var_v\n"
ROWS = "0,100,a,1.5,2.5,0.25,0.01,0.36\n0,100,b,3,4,1,0,1\n7,50,a,5,6,1,0,1\n"


def write(folder: Path, text: str) -> Path:
    path = folder / "observations.csv"
    path.write_bytes(text.encode())
    return path


def test_one_view_per_frame_even_when_stamps_go_back(tmp_path: Path) -> None:
    first, second = read_views(write(tmp_path, HEADER + ROWS))
    assert (first.frame, first.stamp_ns, first.landmarks) == (0, 100, ("a", "b"))
    assert first.pixels.tolist() == [[1.5, 2.5], [3.0, 4.0]]
    assert first.covariances[0].tolist() == [[0.25, 0.01], [0.01, 0.36]]
    assert first.scores is None
    assert (second.frame, second.stamp_ns) == (7, 50)


def test_columns_in_any_order_with_score_and_windows_line_ends(tmp_path: Path) -> None:
    header = "\ufeffscore,landmark,frame,stamp_ns,u_px,v_px,var_u,cov_uv,var_v\r\n"
    text = header + "0.5,a,0,1,1,2,3,4,5\r\n\r\n,b,0,1,1,2,3,4,5\r\n"
    (view,) = read_views(write(tmp_path, text))
    assert view.scores is not None
    assert np.array_equal(view.scores, [0.5, np.nan], equal_nan=True)


def test_a_row_without_a_landmark_is_an_empty_frame(tmp_path: Path) -> None:
    empty, seen = read_views(write(tmp_path, HEADER + "3,30,,,,,,\n4,40,a,1,2,3,4,5\n"))
    assert (empty.frame, empty.stamp_ns, empty.landmarks) == (3, 30, ())
    assert empty.pixels.shape == (0, 2)
    assert seen.landmarks == ("a",)


def test_cells_that_are_not_finite_pass_for_the_estimator_to_drop(tmp_path: Path) -> None:
    (view,) = read_views(write(tmp_path, HEADER + "0,1,a,nan,,inf,0,-1\n0,1,a,1,2,1,0,1\n"))
    assert np.array_equal(view.pixels, [[np.nan, np.nan], [1.0, 2.0]], equal_nan=True)
    assert view.covariances[0, 0, 0] == np.inf
    assert view.landmarks == ("a", "a")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", ":1: expected frame,stamp_ns"),
        ("frame;stamp_ns\n", ":1: unknown column 'frame;stamp_ns'"),
        (HEADER.replace("u_px", "u"), ":1: unknown column 'u'"),
        (HEADER.replace(",var_v", ""), ":1: expected frame,stamp_ns"),
        (HEADER.replace("var_v", "var_u"), ":1: expected frame,stamp_ns"),
        (HEADER.replace("var_v", "var_v,var_v"), ":1: expected frame,stamp_ns"),
        (HEADER + ROWS + "8,1,a,1,2,3,4\n", ":5: expected 8 cells, got 7"),
        (HEADER + ROWS + "8,1,a,1,2,3,4,5,6\n", ":5: expected 8 cells, got 9"),
        (HEADER + "x,1,a,1,2,3,4,5\n", ":2: frame: expected a whole number, got 'x'"),
        (HEADER + "1.0,1,a,1,2,3,4,5\n", ":2: frame: expected a whole number, got '1.0'"),
        (HEADER + "1,1e9,a,1,2,3,4,5\n", ":2: stamp_ns: expected a whole number, got '1e9'"),
        (HEADER + "1,9223372036854775808,a,1,2,3,4,5\n", ":2: stamp_ns: expected a whole number"),
        (HEADER + "1," + "9" * 6000 + ",a,1,2,3,4,5\n", ":2: stamp_ns: expected a whole number"),
        (HEADER + "1,²,a,1,2,3,4,5\n", ":2: stamp_ns: expected a whole number"),
        (HEADER + "1,,a,1,2,3,4,5\n", ":2: stamp_ns: expected a whole number, got ''"),
        (HEADER + "1,1,a,1,2,3,4,five\n", ":2: var_v: expected a number, got 'five'"),
        (HEADER + "1,1,a,1_0,2,3,4,5\n", ":2: u_px: expected a number, got '1_0'"),
        (HEADER + "0,100,a,1,2,1,0,1\n0,101,b,1,2,1,0,1\n", ":3: frame 0 has stamp_ns 100 and 101"),
        (HEADER + ROWS + "0,100,c,1,2,1,0,1\n", ":5: rows of frame 0 do not stand together"),
        (HEADER + '0,1,"a,1,2,3,4,5\n', "malformed CSV"),
        (HEADER + "0,1," + "a" * 70_000 + ",1,2,3,4,5\n", ":2: line longer than 65536 bytes"),
        (HEADER + '0,1,"' + "a\n" * 90_000 + '",1,2,3,4,5\n', "malformed CSV: field larger than field limit"),
    ],
)
def test_a_wrong_table_is_named_by_line(tmp_path: Path, text: str, message: str) -> None:
    path = write(tmp_path, text)
    with pytest.raises(InputError) as caught:
        list(read_views(path))
    assert f"{path}" in str(caught.value)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_views_before_a_wrong_line_come_through(tmp_path: Path) -> None:
    views = read_views(write(tmp_path, HEADER + ROWS + "8,1,a,1,2,1,0,1\n9,torn"))
    assert [view.frame for view in islice(views, 2)] == [0, 7]
    with pytest.raises(InputError, match=":6: expected 8 cells, got 2"):
        list(views)


def test_what_is_no_table(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"ending in \.csv or \.parquet"):
        read_views(tmp_path / "observations.txt")
    for name in ("none.csv", "none.parquet"):
        with pytest.raises(InputError):
            list(read_views(tmp_path / name))
        with pytest.raises(InputError):
            count_observations(tmp_path / name)
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(InputError, match="directory"):
        list(read_views(tmp_path / "folder.csv"))
    path = tmp_path / "bytes.csv"
    path.write_bytes(HEADER.encode() + b"0,1,\xff,1,2,3,4,5\n")
    with pytest.raises(InputError, match=r"bytes\.csv:2: byte 0xff is not UTF-8 text"):
        list(read_views(path))
    path = tmp_path / "no.parquet"
    path.write_bytes(b"PAR1 not really PAR1")
    with pytest.raises(InputError, match="no readable Parquet table"):
        list(read_views(path))


def test_parquet_has_the_same_columns(tmp_path: Path) -> None:
    views = list(read_views(write(tmp_path, HEADER + ROWS + "9,9,,,,,,\n")))
    write_views(tmp_path / "o.parquet", views)
    again = list(read_views(tmp_path / "o.parquet"))
    assert count_observations(tmp_path / "o.parquet") == count_observations(tmp_path / "observations.csv") == 4
    assert [view.landmarks for view in again] == [("a", "b"), ("a",), ()]
    assert again[0].pixels.tolist() == views[0].pixels.tolist()


def test_parquet_columns_are_checked(tmp_path: Path) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    good = {"frame": [0], "stamp_ns": [1], "landmark": ["a"]} | {
        name: [1.0] for name in ("u_px", "v_px", "var_u", "cov_uv", "var_v")
    }
    wrong = [
        ({"frame": [0.5]}, "frame: expected whole numbers, got double"),
        ({"u_px": ["1"]}, "u_px: expected numbers, got string"),
        ({"frame": [None]}, "frame: expected whole numbers"),
        ({"frame": pa.array([None], pa.int64())}, "expected whole numbers, got an empty cell"),
    ]
    for change, message in wrong:
        pq.write_table(pa.table(good | change), tmp_path / "w.parquet")
        with pytest.raises(InputError, match=message):
            list(read_views(tmp_path / "w.parquet"))
    del good["var_v"]
    pq.write_table(pa.table(good), tmp_path / "w.parquet")
    with pytest.raises(InputError, match="expected columns frame"):
        list(read_views(tmp_path / "w.parquet"))


def test_reading_does_not_hold_the_table(tmp_path: Path) -> None:
    """The first view is there although line 300,000 is wrong."""
    path = tmp_path / "long.csv"
    with path.open("w") as stream:
        stream.write(HEADER)
        for frame in range(3000):
            stream.write("".join(f"{frame},{frame},p{index},1,2,1,0,1\n" for index in range(100)))
        stream.write("wrong\n")
    assert isinstance(next(read_views(path)), View)
