# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""`fairlead simulate`: files that `track` takes as they are, the truth apart, the same bytes for the same recipe."""

import csv
import json
import shutil
from pathlib import Path

import numpy as np
import pytest

import fairlead as fl
from fairlead.cli import main
from fairlead.io.poses import read_truth
from fairlead.io.target import load_target
from tests.regression.conftest import TARGET

SHORT = """
target = "frigate"
camera = "frigate"
[trajectory]
kind = "arc"
duration_s = 10.0
[frames]
rate_hz = 10.0
drop_share = 0.1
[model]
sigma_m = 1.0
[noise]
sigma_px = 0.5
[dropout]
share = 0.1
[[range]]
rate_hz = 2.0
[attitude]
rate_hz = 4.0
"""

BOX = """
target = "target.toml"
camera = "camera.yaml"
[trajectory]
kind = "recorded"
file = "flown.tum"
[occlusion]
kind = "mesh"
"""


def files(folder: Path, *, but: tuple[str, ...] = ()) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.name not in but}


def complaint(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert error.startswith("fairlead: ")
    assert error.count("\n") == 1
    return error


@pytest.fixture
def scenario(tmp_path: Path) -> Path:
    path = tmp_path / "short.toml"
    path.write_text(SHORT)
    return path


def test_what_is_simulated_can_be_tracked(scenario: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    d, out = tmp_path / "d", tmp_path / "out"
    assert main(["simulate", str(scenario), "-o", str(d)]) == 0
    images = len(read_truth(d / "truth.csv"))
    assert 70 < images < 101
    assert capsys.readouterr().out.startswith(f"{d}: {images} images, ")
    words = [str(d / "observations.csv"), "--target", str(d / "target.toml"), "--camera", str(d / "camera.yaml")]
    assert main(["track", *words, "--truth", str(d / "truth.csv"), "-o", str(out)]) == 0
    metrics = json.loads((out / "metrics.json").read_text())["runs"]
    (values,) = (run["metrics"] for run in metrics.values())
    assert values["coverage_percent"] == 100.0
    paths = (d / "target.toml", d / "target_true.toml", out / "target_refined.toml")
    told, true, refined = (load_target(path) for path in paths)
    before, after = (np.linalg.norm(each.positions - true.positions, axis=1).mean() for each in (told, refined))
    assert after < 0.8 * before


def test_the_truth_stands_apart(scenario: Path, tmp_path: Path) -> None:
    d = tmp_path / "d"
    assert main(["simulate", str(scenario), "-o", str(d), "--seed", "3"]) == 0
    assert set(files(d)) == {
        *("target.toml", "target.npz", "camera.yaml", "observations.csv", "range.csv", "attitude.csv"),
        *("truth.csv", "target_true.toml", "target_true.npz", "observations_true.csv", "scenario.toml", "run.json"),
    }
    true = load_target(d / "target_true.toml")
    assert not true.covariance.any()
    assert (np.abs(load_target(d / "target.toml").positions - true.positions) > 0).all()
    views, exact = list(fl.read_views(d / "observations.csv")), list(fl.read_views(d / "observations_true.csv"))
    assert (
        [v.stamp_ns for v in views] == [v.stamp_ns for v in exact] == [t.stamp_ns for t in read_truth(d / "truth.csv")]
    )
    assert sum(len(v.landmarks) for v in views) < sum(len(v.landmarks) for v in exact) == 20 * len(exact)
    assert len(fl.read_ranges(d / "range.csv")) == 21
    assert len(fl.read_attitudes(d / "attitude.csv")) == 41
    record = json.loads((d / "run.json").read_text())
    assert (record["command"], record["seed"], record["frames"], record["state"]) == ("simulate", 3, len(views), "done")
    assert {item["role"] for item in record["inputs"]} == {"scenario", "target", "camera"}
    assert "numpy" in record["versions"]


def test_the_recipe_gives_the_same_bytes(scenario: Path, tmp_path: Path) -> None:
    a, b, c = (tmp_path / name for name in "abc")
    assert main(["simulate", str(scenario), "-o", str(a), "--seed", "3"]) == 0
    assert main(["simulate", str(a / "scenario.toml"), "-o", str(b)]) == 0
    assert files(b, but=("run.json", "target_true.toml")) == files(a, but=("run.json", "target_true.toml"))
    assert main(["simulate", str(scenario), "-o", str(c), "--seed", "4"]) == 0
    same = [name for name, data in files(c).items() if data == files(a)[name]]
    assert set(same) == {"camera.yaml", "target.npz", "target_true.toml", "target_true.npz"}


def test_a_recorded_flight_with_its_own_target_and_surface(tmp_path: Path) -> None:
    """Flown once, recorded, flown again about a box that hides its far side; the recipe holds all that is needed."""
    import trimesh

    source = tmp_path / "source"
    source.mkdir()
    (source / "target.toml").write_text('mesh = "box.ply"\n' + TARGET)
    trimesh.creation.box((1.99, 1.99, 1.99)).export(source / "box.ply")
    (source / "camera.yaml").write_text((Path(__file__).parents[2] / "data/frigate/camera.yaml").read_text())
    flight = (
        '[trajectory]\nkind = "helix"\nradius_m = 12.0\nstart_height_m = 1.0\nend_height_m = 5.0\nduration_s = 4.0\n'
    )
    (source / "first.toml").write_text('target = "target.toml"\ncamera = "camera.yaml"\n' + flight)
    first, second, third = (tmp_path / name for name in ("first", "second", "third"))
    assert main(["simulate", str(source / "first.toml"), "-o", str(first)]) == 0
    fl.write_trajectory_tum(source / "flown.tum", read_truth(first / "truth.csv"))
    (source / "box.toml").write_text(BOX)
    assert main(["simulate", str(source / "box.toml"), "-o", str(second)]) == 0
    np.testing.assert_allclose(
        [pose.T_camera_target for pose in read_truth(second / "truth.csv")],
        [pose.T_camera_target for pose in read_truth(first / "truth.csv")],
        atol=1e-9,
    )
    assert 2 <= min(len(view.landmarks) for view in fl.read_views(second / "observations.csv")) <= 5
    shutil.rmtree(source)
    assert main(["simulate", str(second / "scenario.toml"), "-o", str(third)]) == 0
    for name in ("observations.csv", "target.npz", "truth.csv"):
        assert (third / name).read_bytes() == (second / name).read_bytes()


def test_nothing_stays_of_an_earlier_flight(scenario: Path, tmp_path: Path) -> None:
    d = tmp_path / "d"
    assert main(["simulate", str(scenario), "-o", str(d)]) == 0
    (d / "notes.txt").write_text("mine")
    assert main(["simulate", "arc", "-o", str(d)]) == 0
    assert not (d / "range.csv").exists()
    assert not (d / "attitude.csv").exists()
    assert (d / "notes.txt").read_text() == "mine"


def test_another_target_may_fly_the_same(scenario: Path, tmp_path: Path, marker_pen_files: Path) -> None:
    words = ["--target", str(marker_pen_files / "target.toml"), "--camera", str(marker_pen_files / "camera.yaml")]
    assert main(["simulate", str(scenario), "-o", str(tmp_path / "d"), *words]) == 0
    with (tmp_path / "d" / "observations.csv").open() as stream:
        assert next(csv.DictReader(stream))["landmark"].startswith("tag")


@pytest.fixture
def marker_pen_files(repository: Path) -> Path:
    return repository / "data" / "marker_pen"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (SHORT + "[noise]\n", "malformed TOML"),
        (SHORT.replace("sigma_px", "sigma"), "noise.sigma: unknown key; did you mean 'sigma_px'?"),
        (SHORT + "[pointing]\nat_m = [0, 0, 0]\n[swaps]\nshare = 2\n", "swaps.share: expected a share between 0 and 1"),
        (SHORT.replace('kind = "arc"', 'kind = "approach"'), "trajectory.duration_s: unknown key"),
        (SHORT + "[pointing]\nat_m = [-965.9258262890683, 0.0, 0.0]\n", "straight above"),
    ],
)
def test_a_bad_scenario_is_2_and_writes_nothing(
    text: str, message: str, scenario: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scenario.write_text(text)
    assert message in complaint(["simulate", str(scenario), "-o", str(tmp_path / "d")], capsys)
    assert not (tmp_path / "d").exists()


def test_names_and_seeds_that_are_wrong_are_2(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    error = complaint(["simulate", "rolling-ship", "-o", str(tmp_path / "d")], capsys)
    assert "did you mean 'rolling-ship-" in error
    error = complaint(["simulate", "arc", "-o", str(tmp_path / "d"), "--seed", "-1"], capsys)
    assert "--seed: expected a whole number >= 0, got -1" in error
    assert not (tmp_path / "d").exists()


def test_the_recipe_is_not_written_over(scenario: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = files(tmp_path)
    error = complaint(["simulate", str(scenario), "-o", str(tmp_path)], capsys)
    assert "where the results go" in error
    assert files(tmp_path) == before
