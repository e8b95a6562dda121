# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A study is stopped, killed, started again, replayed, and refused."""

import importlib
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fairlead.cli import main
from fairlead.config import StudyConfig, UsageError
from fairlead.io.errors import InputError
from fairlead.study import replay_run, run_study
from fairlead.study.rows import STREAM, TABLE, read_rows
from fairlead.study.run import missing_blocks
from fairlead.study.scores import COLUMNS
from fairlead.study.settings import settings_of

pq: Any = importlib.import_module("pyarrow.parquet")

FAST = ("epnp", "window", "true-model", "bound")
ORDER = [("setting", "ascending"), ("run", "ascending"), ("method", "ascending")]
COMPARED = [name for name in ("setting", "run", "method", *COLUMNS) if name != "milliseconds"]


def config(folder: Path, **changes: Any) -> StudyConfig:
    return StudyConfig(**{"study": "noise", "output": folder, "runs": 3, "methods": FAST, "threads": 1, **changes})


def numbers(folder: Path) -> dict[str, list[Any]]:
    """All rows in order, without times; NaN as None, so that they compare."""
    table = pq.read_table(folder / TABLE).sort_by(ORDER).select(COMPARED).to_pydict()
    return {n: [None if isinstance(v, float) and v != v else v for v in column] for n, column in table.items()}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study that nobody disturbed."""
    folder = tmp_path_factory.mktemp("whole")
    run_study(config(folder))
    return folder


def test_it_writes_a_row_per_run_and_method(whole):
    rows = pq.read_table(whole / TABLE)
    assert rows.num_rows == 8 * 3 * len(FAST)
    assert not (whole / STREAM).exists()
    assert (whole / "summary.csv").read_text(encoding="utf-8").count("\n") == 1 + 8 * len(FAST)
    assert "| s0.25-a90-m1-o0-v10 |" in (whole / "tables.md").read_text(encoding="utf-8")


def test_what_is_there_is_not_done_again(whole):
    before = numbers(whole)
    assert run_study(config(whole)).new_runs == 0
    assert numbers(whole) == before


def test_more_runs_add_to_what_is_there(tmp_path, whole):
    run_study(config(tmp_path, runs=1))
    summary = run_study(config(tmp_path, threads=2))
    assert summary.new_runs == 16
    assert numbers(tmp_path) == numbers(whole)


def test_a_stream_that_was_cut_off_is_read_up_to_there(tmp_path, whole):
    """As after kill -9 or a full disk: the last batch is torn."""
    (tmp_path / "study.json").write_bytes((whole / "study.json").read_bytes())
    stream = record_stream(tmp_path)
    for cut in (len(stream) // 3, len(stream) - 40):
        (tmp_path / STREAM).write_bytes(stream[:cut])
        kept = read_rows(tmp_path).num_rows
        assert 0 < kept < 8 * 3 * len(FAST)
        assert run_study(config(tmp_path)).new_runs > 0
        assert numbers(tmp_path) == numbers(whole)


def record_stream(folder: Path) -> bytes:
    """The bytes of a whole study's stream."""
    from fairlead.study.backends import with_threads
    from fairlead.study.rows import SCHEMA, row_stream
    from fairlead.study.run import chosen_settings, task_of

    task, settings = task_of(config(folder)), chosen_settings(config(folder))
    with row_stream(folder, SCHEMA.empty_table()) as stream:
        for result in with_threads(task, missing_blocks(settings, 3, {}), 1):
            stream.write(result)
    return (folder / STREAM).read_bytes()


@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGKILL, -9)])
def test_it_goes_on_after_a_signal(tmp_path, number, status):
    arguments = ["study", "noise", "-o", str(tmp_path), "--methods", *FAST, "--threads", "1", "--only", "s1-*"]
    command = [sys.executable, "-m", "fairlead", *arguments, "--runs", "100000"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, env={**os.environ, "OMP_NUM_THREADS": "1"})
    deadline = time.monotonic() + 60.0
    while time.monotonic() < deadline and not (
        (tmp_path / STREAM).exists() and (tmp_path / STREAM).stat().st_size > 20_000
    ):
        time.sleep(0.02)
    process.send_signal(number)
    _, error = process.communicate(timeout=60)
    assert process.returncode == status, error
    done = read_rows(tmp_path).num_rows // len(FAST)
    assert done > 0
    summary = run_study(config(tmp_path, only="s1-*", runs=done + 2))
    assert 0 < summary.new_runs <= 34  # the two, and a block that may have been torn
    rows = pq.read_table(tmp_path / TABLE)
    assert rows.num_rows == len(FAST) * rows.filter(pc_method("bound")).num_rows


def pc_method(name: str) -> Any:
    return importlib.import_module("pyarrow.compute").field("method") == name


def test_replay_is_the_row(whole, capsys):
    setting = settings_of("noise")[4]
    found = replay_run(config(whole, replay=(setting.name, 2)))
    rows = numbers(whole)
    for one in found.methods:
        at = list(zip(rows["setting"], rows["run"], rows["method"], strict=True)).index(
            (setting.name, 2, one.method.name)
        )
        for name in COLUMNS:
            if name != "milliseconds":
                value = one.row[name][0]
                assert rows[name][at] == (None if np.isnan(value) else value), (one.method.name, name)
    assert main(["study", "noise", "-o", str(whole), "--replay", setting.name, "2"]) == 0
    out = capsys.readouterr().out
    assert all(name in out for name in FAST)


def test_another_study_is_not_mixed_in(whole):
    with pytest.raises(InputError, match="its seed is 0, expected 1"):
        run_study(config(whole, seed=1))
    with pytest.raises(InputError, match="its study is noise, expected angle"):
        run_study(config(whole, study="angle"))


def test_a_broken_record_is_named(tmp_path):
    (tmp_path / "study.json").write_text("{}", encoding="utf-8")
    with pytest.raises(InputError, match="no record of a study"):
        run_study(config(tmp_path))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--runs", "0"], "--runs: expected a whole number >= 1, got 0"),
        (["--methods", "best"], "--methods: expected some of epnp"),
        (["--only", "x"], "--only: 'x' matches none of"),
        (["--replay", "s7", "1"], "--replay: expected the name of a setting"),
        (["--backend", "dask"], "--backend dask and --scheduler ADDRESS go together"),
    ],
)
def test_arguments_that_make_no_sense(arguments, message, tmp_path, capsys):
    assert main(["study", "noise", "-o", str(tmp_path / "out"), *arguments]) == 2
    assert message in capsys.readouterr().err


def test_blocks_take_every_setting_in_turn():
    settings = settings_of("noise")[:2]
    blocks = missing_blocks(settings, 70, {settings[0].name: {0, 1}})
    assert [(setting.name, runs[0], len(runs)) for setting, runs in blocks] == [
        (settings[1].name, 0, 32),
        (settings[0].name, 2, 32),
        (settings[1].name, 32, 32),
        (settings[0].name, 34, 32),
        (settings[1].name, 64, 6),
        (settings[0].name, 66, 4),
    ]


def test_a_whole_study_draws_its_figures(tmp_path):
    for kind, only, figures in (
        ("noise", "s[12]-*", {"noise.png", "noise_window.png", "noise_cost.png"}),
        ("angle", "s1-a[59]*", {f"{a}{b}.png" for a in ("angle", "segments") for b in ("", "_window", "_cost")}),
        ("grid", "s1-a*-m1-*", {"grid_rotation.png", "grid_translation.png", "grid_model.png"}),
    ):
        methods = ("epnp", "window", "map", "bound")
        summary = run_study(config(tmp_path / kind, study=kind, only=only, runs=2, methods=methods))
        assert {path.name for path in summary.files} == figures | {"summary.csv", "tables.md"}
        assert all(path.stat().st_size > 5_000 for path in summary.files if path.suffix == ".png")


def test_the_record_says_what_was_asked(whole):
    record = json.loads((whole / "study.json").read_text(encoding="utf-8"))
    assert record["identity"]["methods"] == list(FAST)
    assert record["runs"] == 3


def test_dask_gives_the_same_numbers(tmp_path, whole):
    distributed = pytest.importorskip("distributed", reason="needs the extra dask")
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None
    ) as cluster:
        run_study(config(tmp_path, backend="dask", scheduler=cluster.scheduler_address, threads=None))
    assert numbers(tmp_path) == numbers(whole)


def test_a_cluster_that_is_not_there_is_named(tmp_path):
    pytest.importorskip("distributed", reason="needs the extra dask")
    with pytest.raises(UsageError, match="no dask scheduler answers"):
        run_study(config(tmp_path, backend="dask", scheduler="tcp://127.0.0.1:9"))
