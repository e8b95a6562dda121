# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""`fairlead reproduce` on tables: sections, resume, what is missing is said."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from fairlead.cli import main
from fairlead.config import ReproduceConfig
from fairlead.reproduce import reproduce, work
from fairlead.reproduce.methods import OURS
from fairlead.reproduce.sequences import Sequence

FROM_TABLES = ("landmarks", "poses", "model", "times", "curves", "single_landmarks")


def config(sequence: Sequence, folder: Path, **changes: object) -> ReproduceConfig:
    told = {"output": folder, "seeds": 2, "sequences": (sequence.folder,), "only": FROM_TABLES}
    return ReproduceConfig(**{**told, **changes})  # type: ignore[arg-type]


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


@pytest.fixture(scope="module")
def made(sequence: Sequence, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("report")
    reproduce(config(sequence, folder))
    return folder


def test_each_network_has_its_error(made):
    found = {row["network"]: row for row in rows(made / "table2.csv")}
    assert float(found["heatmap"]["mean_px"]) == pytest.approx(0.7 * np.sqrt(np.pi / 2), rel=0.1)
    assert float(found["RTMPose"]["mean_px"]) == pytest.approx(1.4 * np.sqrt(np.pi / 2), rel=0.1)


def test_every_method_is_in_the_table_with_an_interval(made):
    table = rows(made / "table3_orbit-2.0.csv")
    assert [row["method"] for row in table] == 2 * ["epnp", "window", *OURS, "true-model", "bound"]
    ours, epnp = table[2], table[0]
    assert float(ours["translation_m"]) < float(epnp["translation_m"])
    assert float(ours["translation_m_low95"]) <= float(ours["translation_m"]) <= float(ours["translation_m_high95"])
    assert float(table[1]["failed"]) == 1.0  # the window is never full


def test_a_missed_target_is_marked(made):
    record = json.loads((made / "sections" / "poses.json").read_text(encoding="utf-8"))
    for name in ("table3_bound", "table3_targets"):
        targets = next(table for table in record["tables"] if table["name"] == name)
        flagged = rows(made / f"{name}.csv")
        marks = [mark for line in targets["missed"] for mark in line]
        assert any(marks) == any(row[key] == "True" for row in flagged for key in row if key.endswith("_missed"))
    near = rows(made / "table3_bound.csv")
    assert [row["rotation_bound_missed"] == "True" for row in near] == [
        float(row["rotation_over_bound"]) > float(row["target"]) for row in near
    ]
    missed = [
        any(row[f"{name}_bound_missed"] == "True" for name in ("rotation", "translation", "model")) for row in near
    ]
    assert [bool(row["reason"]) for row in near] == missed


def test_the_published_table_has_a_column_per_network_and_method(made):
    (row,) = rows(made / "table3_translation.csv")
    for network in ("heatmap", "RTMPose"):
        for line in rows(made / "table3_orbit-2.0.csv"):
            if line["network"] == network and line["method"] in ("epnp", "window", *OURS):
                assert row[f"{network}_{line['method']}"] == line["translation_all_m"]
    said = (made / "report.md").read_text(encoding="utf-8")
    assert "Not here: PP-TinyPose on orbit-2.0: no images and no table of its detections" in said


def test_theirs_stand_beside_ours_and_are_marked(made):
    theirs = [row for row in rows(made / "table5.csv") if row["where"].startswith("published")]
    assert {row["total_ms"] for row in theirs} == {"8.15", "29.15", "32.5", "36.15"}


def test_the_page_holds_everything(made):
    page = (made / "report.html").read_text(encoding="utf-8")
    assert "http" not in page.replace("http://www.w3.org", "")
    assert page.count("<svg") == 2
    assert "<script" not in page
    assert "Table 2" in (made / "report.md").read_text(encoding="utf-8")


def test_nothing_is_solved_twice(sequence, made, monkeypatch):
    def never(*_: object) -> None:
        raise AssertionError("solved again")

    before = (made / "table3_orbit-2.0.csv").read_bytes()
    monkeypatch.setattr(work, "solve", never)
    reproduce(config(sequence, made, only=("poses",)))
    assert (made / "table3_orbit-2.0.csv").read_bytes() == before
    assert "Table 4" in (made / "report.md").read_text(encoding="utf-8")  # sections of the first call stay
    with pytest.raises(AssertionError, match="solved again"):
        reproduce(config(sequence, made, only=("poses",), seeds=3))


def test_a_run_that_was_cut_short_is_done_again(sequence, made, tmp_path):
    cache = tmp_path / "cache"
    reproduce(config(sequence, tmp_path / "a", only=("model",), seeds=1, cache=cache))
    files = sorted((cache / "runs").rglob("*.npz"))
    assert len(files) == 2  # two networks
    files[0].rename(files[0].with_name(f".{files[0].name}.part"))
    reproduce(config(sequence, tmp_path / "a", only=("model",), seeds=1, cache=cache))
    assert sorted((cache / "runs").rglob("*.npz")) == files


def test_what_is_missing_is_said(sequence, tmp_path, capsys):
    folder = str(sequence.folder)
    assert main(["reproduce", "--only", "overlay", "weather", "--sequences", folder, "-o", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert "overlay: orbit-2.0: no images" in said
    assert "no weather was rendered" in said
    assert "no weather was rendered" in (tmp_path / "report.md").read_text(encoding="utf-8")


def test_an_unknown_section_ends_in_one_line(tmp_path, capsys):
    assert main(["reproduce", "--only", "table2", "-o", str(tmp_path / "x")]) == 2
    assert "--only: expected some of" in capsys.readouterr().err
    assert not (tmp_path / "x").exists()
