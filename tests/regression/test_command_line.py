# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What a user types, and what comes back: exit status, one line, files."""

import json
import subprocess
import sys

import numpy as np
import pytest

import fairlead
from fairlead.cli import main
from fairlead.io.poses import read_poses, read_truth
from fairlead.io.target import load_target
from tests.regression.conftest import Flight

HEADER = "frame,stamp_ns,landmark,u_px,v_px,var_u,cov_uv,var_v\n"


@pytest.mark.parametrize("verb", ["track", "refine"])
def test_a_run_ends_with_0_and_leaves_its_files(flight: Flight, verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert flight.run(verb) == 0
    output = capsys.readouterr()
    assert output.err == ""
    assert output.out == f"{flight.out}: 20 frames, 20 with a pose (100.0%)\n"
    truth = read_truth(flight.folder / "truth.csv")
    for estimate, true in zip(read_poses(flight.out / "poses.csv"), truth, strict=True):
        error = np.linalg.norm(estimate.T_camera_target[:3, 3] - true.T_camera_target[:3, 3])
        assert error < 0.3  # three sigma of the model's 0.1 m
    refined = load_target(flight.out / "target_refined.toml")
    told = load_target(flight.folder / "target.toml")
    assert np.trace(refined.covariance) < np.trace(told.covariance)
    record = json.loads((flight.out / "run.json").read_text())
    assert (record["command"], record["state"], record["frames_with_pose"]) == (verb, "done", 20)
    assert record["estimator"]["max_views"] >= 1
    assert record["seed"] == record["estimator"]["seed"]
    assert {item["role"] for item in record["inputs"]} == {"source", "target", "camera"}


def test_the_same_run_gives_the_same_bytes(flight: Flight) -> None:
    for name in ("a", "b"):
        assert flight.run(output=flight.folder / name) == 0
    for name in ("poses.csv", "trajectory.tum", "target_refined.toml", "observations.csv"):
        assert (flight.folder / "a" / name).read_bytes() == (flight.folder / "b" / name).read_bytes()


def test_an_option_file_reaches_the_estimator(flight: Flight) -> None:
    options = flight.folder / "options.toml"
    options.write_text("max_views = 7\nseed = 3\n")
    assert flight.run(options=options) == 0
    record = json.loads((flight.out / "run.json").read_text())
    assert record["estimator"]["max_views"] == 7
    assert record["seed"] == 3


@pytest.mark.parametrize("verb", ["track", "refine"])
@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("seed = -1", "seed: got -1, expected a whole number >= 0"),
        ("max_views = 99999999999999", "max_views: got 99999999999999, expected a smaller whole number"),
        ("max_views = 3.5", "max_views: expected a whole number, got 3.5"),
        ('gate = "a"', "gate: expected a number, got 'a'"),
        ("gate = -1.0", "gate: got -1.000000, expected a positive number"),
        ('motion = "warp"', "got 'warp', expected none, range, target or world"),
    ],
)
def test_an_option_that_cannot_be_is_blamed_on_its_file(
    flight: Flight, capsys: pytest.CaptureFixture[str], verb: str, line: str, message: str
) -> None:
    options = flight.folder / "options.toml"
    options.write_text(f"{line}\n")
    error = one_line(flight, capsys, status=flight.run(verb, options=options))
    assert error.startswith(f"fairlead: {options}: ")
    assert message in error


def test_too_little_coverage_is_1_and_is_named(flight: Flight, capsys: pytest.CaptureFixture[str]) -> None:
    lines = flight.source.read_text().splitlines(keepends=True)
    flight.source.write_text("".join([lines[0], *lines[1::7]]))  # one landmark a frame
    assert flight.run() == 1
    assert capsys.readouterr().err == "fairlead: coverage 0.0% is below --min-coverage 50.0%\n"
    assert all(not estimate.ok and estimate.reason for estimate in read_poses(flight.out / "poses.csv"))
    assert flight.run(min_coverage="0") == 0


def one_line(flight: Flight, capsys: pytest.CaptureFixture[str], *, status: int) -> str:
    assert status == 2
    error = capsys.readouterr().err
    assert error.startswith("fairlead: ")
    assert error.count("\n") == 1
    assert error.endswith("\n")
    assert not flight.out.exists(), "nothing is written for a file that cannot be used"
    return error


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("target.toml", b"name = ", "malformed TOML"),
        ("target.toml", b'name = "t"\n[[landmark]]\nname = "a"\nposition_m = [1, 2]\n', "expected 3 numbers"),
        (
            "target.toml",
            b'name = "t"\n[prior]\nsigma_m = 1\n[[landmark]]\nname = "a"\nposition_m = [1, 2, 3]\n',
            "at least 4",
        ),
        ("target.toml", b'name = "t"\nmesh = "../../etc/passwd"\n', "expected 1 to"),
        ("camera.yaml", b"camera_matrix: [", "malformed YAML"),
        ("camera.yaml", b"%YAML:1.0\n---\ncamera_matrix: !!opencv-matrix 3\n", "expected an OpenCV matrix"),
        ("camera.yaml", b"\x89PNG", "not UTF-8"),
        ("camera.yaml", b"a: " + b"{a: " * 5000, "nested deeper"),
        ("observations.csv", b"", "expected frame,stamp_ns,landmark"),
        ("observations.csv", HEADER.encode(), "holds no frames"),
        ("observations.csv", HEADER.encode() + b"0,0,p0,1,2,3,4\n", ":2: expected 8 cells, got 7"),
        ("observations.csv", HEADER.encode() + b"0,0,q0,1,2,3,4,5\n", "the target has no landmark 'q0'"),
        ("observations.csv", b"\x00\xff\xfe", "not UTF-8"),
    ],
)
@pytest.mark.parametrize("verb", ["track", "refine"])
def test_a_file_that_cannot_be_used_is_one_line_and_2(
    flight: Flight, capsys: pytest.CaptureFixture[str], verb: str, name: str, content: bytes, message: str
) -> None:
    (flight.folder / name).write_bytes(content)
    error = one_line(flight, capsys, status=flight.run(verb))
    assert message in error
    assert str(flight.folder / name) in error


def test_files_that_are_not_there_and_arguments_that_do_not_go_together(
    flight: Flight, capsys: pytest.CaptureFixture[str]
) -> None:
    none = flight.folder / "none.csv"
    (flight.folder / "images").mkdir()
    for changes, message in [
        ({"source": none}, "No such file"),
        ({"source": flight.folder / "none.mkv"}, "expected observations (.csv, .parquet), a folder of images"),
        ({"target": none}, "No such file"),
        ({"camera": none}, "No such file"),
        ({"truth": none}, "No such file"),
        ({"options": none}, "No such file"),
        ({"camera_name": "cam0"}, "no camera 'cam0'; did you mean 'c'?"),
        ({"detector": "aruco:DICT_4X4_100"}, "holds observations already"),
        ({"source": flight.folder / "images"}, "expected --detector too"),
    ]:
        assert message in one_line(flight, capsys, status=flight.run(**changes))


def test_a_bad_line_in_the_middle_keeps_what_was_computed(flight: Flight, capsys: pytest.CaptureFixture[str]) -> None:
    lines = flight.source.read_text().splitlines(keepends=True)
    flight.source.write_text("".join(lines[: 1 + 7 * 10]) + "torn")
    assert flight.run() == 2
    assert capsys.readouterr().err == f"fairlead: {flight.source}:72: expected 8 cells, got 1\n"
    assert len(read_poses(flight.out / "poses.csv")) == 9  # the tenth frame may go on in the torn line
    assert json.loads((flight.out / "run.json").read_text())["state"] == "failed"
    assert load_target(flight.out / "target_refined.toml").landmarks


def test_nothing_that_is_read_is_written_over(flight: Flight, capsys: pytest.CaptureFixture[str]) -> None:
    before = {path: path.read_bytes() for path in flight.folder.iterdir()}
    assert flight.run(output=flight.folder) == 2
    assert "would write over the input" in capsys.readouterr().err
    assert {path: path.read_bytes() for path in flight.folder.iterdir()} == before


def test_results_of_an_earlier_run_do_not_stay(flight: Flight) -> None:
    flight.out.mkdir()
    for name in ("metrics.json", "report.html", "trajectory.tum"):
        (flight.out / name).write_text("old")
    (flight.out / "notes.txt").write_text("mine")
    assert flight.run() == 0
    assert not (flight.out / "metrics.json").exists()
    assert not (flight.out / "report.html").exists()
    assert (flight.out / "notes.txt").read_text() == "mine"


TRACK = ["track", "x.csv", "--target", "t.toml", "--camera", "c.yaml", "-o", "run"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "Expected one of {demo, track, refine"),
        (["fly"], "Unrecognized options: fly"),
        (["track"], "Missing from fairlead track: SOURCE"),
        (["track", "x.csv", "--targte", "x"], "Unrecognized options: --targte"),
        ([*TRACK, "--fps", "0"], "--fps: expected a positive number of frames per second, got 0.0"),
        ([*TRACK, "--fps", "fast"], "could not convert string to float: 'fast'"),
        ([*TRACK, "--min-coverage", "2"], "--min-coverage: expected a share between 0 and 1, got 2.0"),
        ([*TRACK, "--range-bias-sigma-m", "-1"], "--range-bias-sigma-m: expected zero or more metres, got -1.0"),
        ([*TRACK, "--method", "xx"], "invalid choice 'xx' for argument '--method'"),
    ],
)
@pytest.mark.parametrize("terminal", [False, True])
def test_wrong_arguments_are_one_line_and_2(
    arguments: list[str],
    message: str,
    terminal: bool,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(sys.stdout, "isatty", lambda: terminal)
    monkeypatch.setenv("TERM", "xterm")
    assert main(arguments) == 2
    output = capsys.readouterr()
    assert output.out == ""
    assert output.err.startswith("fairlead: ")
    assert message in output.err
    assert output.err.count("\n") == 1
    assert not set(output.err) & set("│─╭\x1b")


def test_the_version_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    output = capsys.readouterr()
    assert output.out == f"fairlead {fairlead.__version__}\n"
    assert output.err == ""


@pytest.mark.parametrize("verb", ["track", "refine"])
def test_observations_with_useless_variances_are_said_once(
    flight: Flight, capsys: pytest.CaptureFixture[str], verb: str
) -> None:
    header, *lines = flight.source.read_text().splitlines()
    spoilt = [",".join([*line.split(",")[:5], "-1.0", "0.0", "-1.0"]) for line in lines]
    if "score" in header:
        spoilt = [f"{line},1.0" for line in spoilt]
    flight.source.write_text("\n".join([header, *spoilt]) + "\n")
    assert flight.run(verb) == 1
    output = capsys.readouterr()
    dropped = "without finite numbers or a positive definite covariance, or of a landmark twice in a frame"
    counts = f"20 frames, 0 with a pose (0.0%), 140 observations dropped ({dropped})"
    assert output.out == f"{flight.out}: {counts}\n"
    assert output.err.count("\n") == 1


def test_a_text_file_is_no_video(flight: Flight, capsys: pytest.CaptureFixture[str]) -> None:
    text = flight.folder / "observations.txt"
    text.write_text(flight.source.read_text())
    tags = flight.folder / "tags.toml"
    tags.write_text(
        (flight.folder / "target.toml").read_text().replace('"p', '"tag').replace('"\nposition', '_tl"\nposition')
    )
    error = one_line(flight, capsys, status=flight.run(source=text, detector="aruco:DICT_4X4_100", target=tags))
    assert error == f"fairlead: {text}: is text; expected a video\n"


def test_help_names_every_verb_and_loads_nothing_heavy() -> None:
    program = (
        "import sys, fairlead.cli\n"
        "try:\n    fairlead.cli.main(['--help'])\nexcept SystemExit as ended:\n    assert ended.code == 0\n"
        "heavy = {'numpy', 'scipy', 'cv2', 'matplotlib', 'pyarrow', 'jinja2', 'yaml'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    for verb in ("demo", "track", "refine", "evaluate", "simulate", "study", "render"):
        assert verb in done.stdout


def test_import_is_silent_and_loads_nothing() -> None:
    program = (
        "import sys, fairlead as fl\n"
        "assert 'numpy' not in sys.modules and 'fairlead._core' not in sys.modules\n"
        "assert callable(fl.load_target) and fl.Tracker and fl.__version__ and 'refine' in dir(fl)\n"
        "assert not hasattr(fl, 'nothing')\n"
    )
    done = subprocess.run([sys.executable, "-W", "error", "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == done.stderr == ""


def test_parquet_gives_what_csv_gives(flight: Flight) -> None:
    from fairlead.io.observations import read_views, write_views

    parquet = flight.folder / "observations.parquet"
    write_views(parquet, read_views(flight.source))
    assert flight.run(source=parquet, output=flight.folder / "parquet") == 0
    assert flight.run() == 0
    assert (flight.folder / "parquet" / "poses.csv").read_bytes() == (flight.out / "poses.csv").read_bytes()
