# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""`evaluate`, and `--truth` of a run: numbers on stdout, metrics.json and a report beside the run."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from fairlead.cli import main
from fairlead.io.poses import read_poses, read_truth, write_truth
from tests.regression.conftest import Flight


def test_truth_gives_numbers_and_a_report(flight: Flight, capsys: pytest.CaptureFixture[str]) -> None:
    assert flight.run(truth=flight.folder / "truth.csv") == 0
    output = capsys.readouterr()
    assert output.err == ""
    assert "rotation, mean" in output.out
    assert output.out.endswith("20 frames, 20 with a pose (100.0%)\n")
    (run,) = json.loads((flight.out / "metrics.json").read_text())["runs"].values()
    assert run["metrics"]["coverage_percent"] == 100.0
    assert 0.0 < run["metrics"]["rotation_deg"] < 5.0
    assert (flight.out / "report.html").stat().st_size > 10_000


def test_evaluate_into_another_folder_with_the_true_landmarks(
    flight: Flight, capsys: pytest.CaptureFixture[str]
) -> None:
    assert flight.run() == 0
    before = {path.name: path.read_bytes() for path in flight.out.iterdir()}
    judged = flight.folder / "judged"
    words = ["evaluate", str(flight.out), "--truth", str(flight.folder / "truth.csv")]
    assert main([*words, "--target-true", str(flight.folder / "target.toml"), "-o", str(judged)]) == 0
    assert "refined model, raw" in capsys.readouterr().out
    assert (judged / "report.html").exists()
    assert {path.name: path.read_bytes() for path in flight.out.iterdir()} == before


def test_evaluate_without_truth_says_what_the_observations_tell(
    flight: Flight, capsys: pytest.CaptureFixture[str]
) -> None:
    assert flight.run() == 0
    assert main(["evaluate", str(flight.out)]) == 0
    output = capsys.readouterr().out
    assert "reprojection, rms" in output
    assert "rotation, mean" not in output


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        ("folder", "expected a folder written by track or refine"),
        ("run.json", "malformed JSON"),
        ("poses.csv", "expected frame,stamp_ns,tx"),
        ("observations.csv", "expected frame,stamp_ns,landmark"),
        ("target.toml", "malformed TOML"),
        ("truth.csv", "expected frame,stamp_ns,tx"),
    ],
)
def test_a_run_that_cannot_be_judged_is_one_line_and_2(
    flight: Flight, capsys: pytest.CaptureFixture[str], spoil: str, message: str
) -> None:
    assert flight.run() == 0
    capsys.readouterr()
    truth, run = flight.folder / "truth.csv", flight.out
    if spoil == "folder":
        run = flight.folder / "none"
    else:
        (truth if spoil == "truth.csv" else run / spoil).write_text("spoilt{")
    assert main(["evaluate", str(run), "--truth", str(truth)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert message in error


def test_a_truth_that_cannot_be_used_is_found_out_before_the_run(
    flight: Flight, capsys: pytest.CaptureFixture[str]
) -> None:
    (flight.folder / "truth.csv").write_text("frame\n")
    assert flight.run(truth=flight.folder / "truth.csv") == 2
    assert "expected frame,stamp_ns,tx" in capsys.readouterr().err
    assert not flight.out.exists()


def an_hour_off(truth: Path) -> Path:
    """The same truth with other stamps and frames."""
    poses = [
        replace(each, frame=each.frame + 9000, stamp_ns=each.stamp_ns + 3_600 * 10**9) for each in read_truth(truth)
    ]
    write_truth(truth.with_name("late.csv"), poses)
    return truth.with_name("late.csv")


def test_a_truth_of_other_images_is_one_line_and_2(flight: Flight, capsys: pytest.CaptureFixture[str]) -> None:
    truth, none = flight.folder / "truth.csv", flight.folder / "none.csv"
    assert flight.run() == 0
    capsys.readouterr()
    write_truth(none, [])
    came = "got 3600000000000 to 3601900000000 (20)"
    for path, said in ((an_hour_off(truth), came), (none, "got none")):
        before = sorted(flight.out.iterdir())
        assert main(["evaluate", str(flight.out), "--truth", str(path)]) == 2
        output = capsys.readouterr()
        expected = f"{path}: tells of no frame of {flight.out}: expected stamps_ns like 0 to 1900000000 (20), {said}"
        assert output.err == f"fairlead: {expected}\n"
        assert output.out == ""
        assert sorted(flight.out.iterdir()) == before


@pytest.mark.parametrize("verb", ["track", "refine"])
def test_a_run_with_a_truth_of_other_images_stays(
    flight: Flight, capsys: pytest.CaptureFixture[str], verb: str
) -> None:
    late = an_hour_off(flight.folder / "truth.csv")
    assert flight.run(verb, truth=late) == 2
    output = capsys.readouterr()
    assert output.out == f"{flight.out}: 20 frames, 20 with a pose (100.0%)\n"
    assert output.err.startswith(f"fairlead: {late}: tells of no frame of {flight.out}: ")
    assert output.err.count("\n") == 1
    assert json.loads((flight.out / "run.json").read_text())["state"] == "done"
    assert len(read_poses(flight.out / "poses.csv")) == 20
    assert not (flight.out / "report.html").exists()


def test_a_truth_without_poses_is_found_out_before_the_run(flight: Flight, capsys: pytest.CaptureFixture[str]) -> None:
    write_truth(flight.folder / "none.csv", [])
    assert flight.run(truth=flight.folder / "none.csv") == 2
    assert capsys.readouterr().err == f"fairlead: {flight.folder / 'none.csv'}: holds no poses\n"
    assert not flight.out.exists()


def test_true_landmarks_of_another_target_are_one_line_and_2(
    flight: Flight, capsys: pytest.CaptureFixture[str]
) -> None:
    other = flight.folder / "other.toml"
    other.write_text((flight.folder / "target.toml").read_text().replace('"p', '"q'))
    assert flight.run() == 0
    capsys.readouterr()
    words = ["evaluate", str(flight.out), "--truth", str(flight.folder / "truth.csv"), "--target-true", str(other)]
    assert main(words) == 2
    run = flight.out / "target.toml"
    expected = f"{other}: has no landmark of {run}: expected some of p0, p1, p2, p3, ... got q0, q1, q2, q3, ..."
    assert capsys.readouterr().err == f"fairlead: {expected}\n"
    assert not (flight.out / "report.html").exists()


@pytest.mark.parametrize("name", ["poses.csv", "observations.csv"])
def test_a_last_line_that_was_torn_is_left_out(flight: Flight, caplog: pytest.LogCaptureFixture, name: str) -> None:
    assert flight.run() == 0
    torn = flight.out / name
    torn.write_bytes(torn.read_bytes()[:-60])
    assert main(["evaluate", str(flight.out), "--truth", str(flight.folder / "truth.csv")]) == 0
    assert f"{torn}: the last line is torn and left out" in caplog.text
    lines = torn.read_bytes().splitlines(keepends=True)
    torn.write_bytes(b"".join([*lines[:5], b"torn\n", *lines[6:]]))
    assert main(["evaluate", str(flight.out)]) == 2


def test_the_temple_against_its_gantry(temple_ring: Path, tmp_path: Path) -> None:
    words = [str(temple_ring / "observations.csv"), "--target", str(temple_ring / "target.toml")]
    words += ["--camera", str(temple_ring / "camera.yaml"), "-o", str(tmp_path)]
    assert main(["refine", *words]) == 0
    truth = ["--truth", str(temple_ring / "truth.csv"), "--target-true", str(temple_ring / "target_true.toml")]
    assert main(["evaluate", str(tmp_path), *truth]) == 0
    (run,) = json.loads((tmp_path / "metrics.json").read_text())["runs"].values()
    assert run["metrics"]["landmarks_sim3_m"] <= 1e-4
