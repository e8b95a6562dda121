# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Judging run folders: metrics.json, errors.csv, report.html."""

import csv
import json
from pathlib import Path

import pytest

from fairlead.evaluate import evaluate_run, evaluate_runs
from fairlead.io.camera import save_camera
from fairlead.io.errors import InputError
from fairlead.io.observations import write_views
from fairlead.io.poses import write_poses, write_truth
from fairlead.io.run_record import RunRecord, write_run_record
from fairlead.io.target import save_target
from tests.unit.report_flight import CAMERA, STEP_NS, estimates, parsed, target, truth, views


def write_run(folder: Path, count: int = 12, method: str = "map") -> Path:
    """A folder as `track` leaves it, written through the same functions."""
    folder.mkdir()
    save_target(folder / "target.toml", target(0.2))
    save_target(folder / "target_refined.toml", target(0.02, 0.02))
    save_camera(folder / "camera.yaml", CAMERA)
    write_poses(folder / "poses.csv", estimates(count, 3))
    write_views(folder / "observations.csv", views(count))
    (folder / "timing.csv").write_text(
        "frame,stamp_ns,detect_ms,update_ms\n"
        + "".join(f"{k},{STEP_NS * k},0.1,{0.2 + 0.01 * k}\n" for k in range(count))
    )
    record = RunRecord(command="track", state="done", options={"method": method}, inputs=(), frames=count)
    write_run_record(folder / "run.json", record)
    return folder


def test_run_folder(tmp_path: Path) -> None:
    run = write_run(tmp_path / "run")
    write_truth(tmp_path / "truth.csv", truth(12))
    save_target(tmp_path / "target_true.toml", target(0.0))
    (tmp_path / "mesh.obj").write_text("v 0 0 0\nv 3 0 0\nv 0 3 0\nv 0 0 3\nf 1 2 3\nf 1 2 4\n")
    report = evaluate_run(
        run, tmp_path / "truth.csv", target_true=tmp_path / "target_true.toml", mesh=tmp_path / "mesh.obj"
    )
    assert report == run / "report.html"
    parsed(report.read_text(encoding="utf-8"))
    document = json.loads((run / "metrics.json").read_text())
    metrics = document["runs"]["map"]["metrics"]
    # The estimates are the true poses times Exp(0.01 m, 0.01 rad): 0.01 sqrt(2 x 4 / pi) = 0.016 in the mean.
    assert metrics["translation_m"] == pytest.approx(0.016, rel=0.5)
    assert metrics["coverage_percent"] == pytest.approx(100.0 * 11 / 12)
    assert metrics["add_m"] > 0.0
    assert metrics["update_p50_ms"] == pytest.approx(0.255)
    with (run / "errors.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 12
    assert (rows[3]["failed"], rows[3]["rotation_deg"]) == ("1", "")
    assert float(rows[0]["translation_m"]) > 0.0


def test_several_runs_side_by_side_without_truth(tmp_path: Path) -> None:
    runs = {name: write_run(tmp_path / name, method=name) for name in ("epnp", "map")}
    report = evaluate_runs(runs, output=tmp_path / "both")
    assert sorted(item.name for item in report.parent.iterdir()) == [
        *("errors_epnp.csv", "errors_map.csv", "metrics.json", "report.html")
    ]
    assert list(json.loads((report.parent / "metrics.json").read_text())["runs"]) == ["epnp", "map"]


def test_what_cannot_be_used_is_one_line(tmp_path: Path) -> None:
    run = write_run(tmp_path / "run")
    (tmp_path / "mesh.ply").write_bytes(b"ply\nformat ascii 1.0\n")
    with pytest.raises(InputError, match=r"mesh\.ply: no readable mesh"):
        evaluate_run(run, mesh=tmp_path / "mesh.ply")
    with pytest.raises(InputError, match=r"truth\.csv"):
        evaluate_run(run, tmp_path / "truth.csv")
    (run / "run.json").unlink()
    with pytest.raises(InputError, match=r"run\.json"):
        evaluate_run(run)
    assert not (run / "report.html").exists()
