# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Killed, stopped, disk full: what was computed can be read."""

import json
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from fairlead.io.observations import read_views
from fairlead.io.poses import read_poses
from fairlead.io.target import load_target
from fairlead.io.timing import read_timing
from tests.regression.conftest import Flight

ENOUGH_LINES = 300


def wait_for_lines(path: Path, count: int, process: "subprocess.Popen[str]") -> int:
    """Until the file has `count` lines; returns how many there are."""
    end_s = time.monotonic() + 60.0
    while time.monotonic() < end_s:
        lines = path.read_bytes().count(b"\n") if path.exists() else 0
        if lines >= count:
            return lines
        assert process.poll() is None, process.communicate()[1]
        time.sleep(0.01)
    raise AssertionError(f"{path} did not get {count} lines")


def test_kill_9_leaves_everything_up_to_the_last_frame(long_flight: Flight) -> None:
    process = long_flight.start()
    seen = wait_for_lines(long_flight.out / "poses.csv", ENOUGH_LINES, process)
    process.kill()
    process.communicate()
    estimates = read_poses(long_flight.out / "poses.csv")
    assert len(estimates) >= seen - 1
    assert [estimate.frame for estimate in estimates] == list(range(len(estimates)))
    assert abs(sum(1 for _ in read_views(long_flight.out / "observations.csv")) - len(estimates)) <= 1
    assert abs(len(read_timing(long_flight.out / "timing.csv")) - len(estimates)) <= 1
    assert json.loads((long_flight.out / "run.json").read_text())["state"] == "running"


@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_closes_every_file(long_flight: Flight, number: signal.Signals, status: int) -> None:
    process = long_flight.start()
    seen = wait_for_lines(long_flight.out / "poses.csv", ENOUGH_LINES, process)
    while process.poll() is None:  # somebody impatient
        process.send_signal(number)
        time.sleep(0.001)
    _, error = process.communicate(timeout=30)
    assert process.returncode == status
    assert error == "fairlead: stopped; what was written stays readable\n"
    estimates = read_poses(long_flight.out / "poses.csv")
    assert len(estimates) >= seen - 1
    record = json.loads((long_flight.out / "run.json").read_text())
    assert record["state"] == "interrupted"
    assert abs(record["frames"] - len(estimates)) <= 1
    assert load_target(long_flight.out / "target_refined.toml").landmarks


def test_a_batch_that_takes_long_can_be_stopped(long_flight: Flight) -> None:
    process = long_flight.start("refine")
    wait_for_lines(long_flight.out / "observations.csv", 4_000 * 7, process)
    time.sleep(0.5)  # now it solves
    start_s = time.monotonic()
    process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=60)
    if process.returncode == 0:
        pytest.skip("it was done before it could be stopped")
    assert process.returncode == 130
    assert error == "fairlead: stopped; what was written stays readable\n"
    assert time.monotonic() - start_s < 20.0
    assert json.loads((long_flight.out / "run.json").read_text())["state"] == "interrupted"


def test_a_full_disk_is_one_line_and_keeps_whole_lines(long_flight: Flight) -> None:
    """No file may grow beyond 200 kB, which poses.csv reaches first or observations.csv."""
    limit = 200_000

    def limited() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    command = [sys.executable, "-m", "fairlead", *long_flight.arguments()]
    done = subprocess.run(command, capture_output=True, text=True, preexec_fn=limited, check=False, timeout=120)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "File too large" in done.stderr
    estimates = read_poses(long_flight.out / "poses.csv")
    assert len(estimates) > 100
    assert (long_flight.out / "poses.csv").read_bytes().endswith(b"\n")
    assert (long_flight.out / "observations.csv").read_bytes().endswith(b"\n")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full here")
@pytest.mark.parametrize("name", ["poses.csv", "observations.csv"])
def test_a_disk_that_is_full_from_the_start(flight: Flight, capsys: pytest.CaptureFixture[str], name: str) -> None:
    from fairlead.io import csv_lines

    opened = csv_lines.Path.open

    def full(path: Path, *arguments: object, **options: object) -> object:
        return opened(Path("/dev/full") if path == flight.out / name else path, *arguments, **options)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(csv_lines.Path, "open", full)
        assert flight.run() == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert f"{flight.out / name}: No space left on device (what was written stays readable)" in error
