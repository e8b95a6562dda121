# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""`fairlead track|refine --range --attitude`: what other sensors say is used, and bad files end in one line."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import fairlead as fl
from fairlead.cli import main
from fairlead.io.poses import read_truth

FLIGHT = """
target = "frigate"
camera = "frigate"
[trajectory]
kind = "arc"
angle_deg = 30.0
duration_s = 12.0
[frames]
rate_hz = 25.0
[model]
sigma_m = 1.0
[noise]
sigma_px = 2.0
[motion]
kind = "range"
jerk_density_m_s25 = 0.5
[[range]]
rate_hz = 2.0
sigma_m = 0.5
[attitude]
rate_hz = 25.0
"""


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("flight")
    (folder / "flight.toml").write_text(FLIGHT, encoding="utf-8")
    assert main(["simulate", str(folder / "flight.toml"), "-o", str(folder / "told")]) == 0
    return folder / "told"


def tracked(flight: Path, output: Path, *more: str) -> int:
    words = [str(flight / "observations.csv"), "--target", str(flight / "target.toml")]
    return main(["track", *words, "--camera", str(flight / "camera.yaml"), "-o", str(output), *more])


def refined(flight: Path, output: Path, *more: str) -> int:
    words = [str(flight / "observations.csv"), "--target", str(flight / "target.toml")]
    return main(["refine", *words, "--camera", str(flight / "camera.yaml"), "-o", str(output), *more])


def range_error(flight: Path, output: Path) -> float:
    """Root mean square over the second half [m]."""
    truth = {pose.stamp_ns: pose.T_camera_target for pose in read_truth(flight / "truth.csv")}
    estimates = [e for e in fl.read_poses(output / "poses.csv") if e.ok]
    later = estimates[len(estimates) // 2 :]
    errors = [np.linalg.norm(e.T_camera_target[:3, 3]) - np.linalg.norm(truth[e.stamp_ns][:3, 3]) for e in later]
    return float(np.sqrt(np.mean(np.square(errors))))


def test_ranges_and_attitudes_of_a_flight_are_used(flight: Path, tmp_path: Path) -> None:
    assert tracked(flight, tmp_path / "images") == 0
    sensors = ("--range", str(flight / "range.csv"), "--attitude", str(flight / "attitude.csv"))
    assert tracked(flight, tmp_path / "ranges", *sensors) == 0
    assert range_error(flight, tmp_path / "ranges") < 4.0
    assert range_error(flight, tmp_path / "ranges") < range_error(flight, tmp_path / "images")


def test_a_whole_flight_uses_them_too(flight: Path, tmp_path: Path) -> None:
    sensors = ("--range", str(flight / "range.csv"), "--attitude", str(flight / "attitude.csv"))
    assert refined(flight, tmp_path / "ranges", *sensors) == 0
    assert range_error(flight, tmp_path / "ranges") < 1.5


@pytest.mark.parametrize("verb", [tracked, refined])
def test_what_a_range_finder_always_reads_too_much_is_found(
    flight: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], verb: Callable[..., int]
) -> None:
    lines = (flight / "range.csv").read_text(encoding="utf-8").splitlines()
    columns = [line.split(",") for line in lines[1:]]
    off = [",".join([stamp, f"{float(r) + 4.0}", *rest]) for stamp, r, *rest in columns]
    (tmp_path / "off.csv").write_text("\n".join([lines[0], *off]) + "\n", encoding="utf-8")
    capsys.readouterr()
    words = ("--range", str(tmp_path / "off.csv"), "--range-bias-sigma-m", "4")
    assert verb(flight, tmp_path / "off", *words) == 0
    said = re.search(r"range finder off by ([+-][\d.]+) ± ([\d.]+) m", capsys.readouterr().out)
    assert said is not None
    bias, sigma = float(said[1]), float(said[2])
    assert 0.0 < sigma <= 4.0
    assert abs(bias - 4.0) < 3.3 * sigma  # 99.9 %
    assert verb(flight, tmp_path / "bad", "--range-bias-sigma-m", "4") == 2
    assert capsys.readouterr().err == "fairlead: --range-bias-sigma-m: expected --range too\n"


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ("stamp_ns,range_m,sigma_m,landmark\n0,1000,0.5,keel\n", "keel"),
        ("stamp_ns,range_m\n0,1000\n", "sigma_m"),
        ("stamp_ns,range_m,sigma_m,landmark\n0,far,0.5,\n", "far"),
    ],
)
def test_a_bad_file_of_ranges_ends_in_one_line(
    flight: Path, tmp_path: Path, lines: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "range.csv").write_text(lines, encoding="utf-8")
    capsys.readouterr()
    assert tracked(flight, tmp_path / "run", "--range", str(tmp_path / "range.csv")) == 2
    error = capsys.readouterr().err.strip()
    assert said in error
    assert "\n" not in error
    assert not (tmp_path / "run" / "poses.csv").exists()


def test_other_methods_have_no_use_for_ranges(flight: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert tracked(flight, tmp_path / "run", "--method", "epnp", "--range", str(flight / "range.csv")) == 2
    assert "--range" in capsys.readouterr().err
