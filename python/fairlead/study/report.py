# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Everything that is written of a finished study: summary.csv, tables.md and the figures."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fairlead.config import StudyKind
from fairlead.study.figures import draw_cost, draw_gain, draw_sensitivity, draw_sweep
from fairlead.study.figures.look import save
from fairlead.study.methods import NAMES
from fairlead.study.rows import results_of
from fairlead.study.scores import COLUMNS
from fairlead.study.settings import VIEWS, Setting
from fairlead.study.summary import Line, summarise
from fairlead.study.tables import write_csv, write_markdown


def write_report(folder: Path, kind: StudyKind, settings: Sequence[Setting], rows: Any) -> list[Path]:
    """Summarise the rows of these settings; returns what was written."""
    lines = summarise(settings, NAMES, results_of(rows, COLUMNS))
    files = [write_csv(folder / "summary.csv", lines), write_markdown(folder / "tables.md", kind, lines)]
    if not {"epnp", "map"} <= {line.method for line in lines}:
        return files  # nothing to compare
    if kind == "noise":
        return files + _noise_figures(folder, settings, lines)
    if kind == "angle":
        return files + _angle_figures(folder, settings, lines)
    return files + _grid_figures(folder, settings, lines)


def _runs(lines: Sequence[Line]) -> int:
    return max(line.statistics["rotation_deg"].runs for line in lines)


def _noise_figures(folder: Path, settings: Sequence[Setting], lines: Sequence[Line]) -> list[Path]:
    x = [setting.sigma_px for setting in settings]
    label, first = "noise [px]", settings[0]
    title = f"{first.angle_deg:g} deg arc at 1 km, {first.views} views, model error 1 m, {_runs(lines)} runs a setting"
    return [
        save(draw_sweep(lines, settings, x, label, title), folder / "noise.png"),
        save(draw_sensitivity(lines, settings, x, label, title), folder / "noise_window.png"),
        save(draw_cost(lines, settings, x, label, title), folder / "noise_cost.png"),
    ]


def _angle_figures(folder: Path, settings: Sequence[Setting], lines: Sequence[Line]) -> list[Path]:
    label, files = "angle [deg]", list[Path]()
    for name, words, chosen in (
        ("angle", f"{VIEWS} views at every angle", [s for s in settings if s.views == VIEWS]),
        ("segments", "one view a degree", [s for s in settings if s.views != VIEWS]),
    ):
        if not chosen:
            continue
        x = [setting.angle_deg for setting in chosen]
        title = f"Arc at 1 km, {words}, {chosen[0].sigma_px:g} px, model error 1 m, {_runs(lines)} runs a setting"
        files += [
            save(draw_sweep(lines, chosen, x, label, title), folder / f"{name}.png"),
            save(draw_sensitivity(lines, chosen, x, label, title), folder / f"{name}_window.png"),
            save(draw_cost(lines, chosen, x, label, title), folder / f"{name}_cost.png"),
        ]
    return files


def _grid_figures(folder: Path, settings: Sequence[Setting], lines: Sequence[Line]) -> list[Path]:
    words = f"error in units of EPnP's on the same flights (below 1: better), {_runs(lines)} runs a setting"
    return [
        save(draw_gain(lines, settings, error, f"{what} {words}"), folder / f"grid_{name}.png")
        for error, name, what in (
            ("rotation_penalised_deg", "rotation", "Rotation"),
            ("translation_penalised_m", "translation", "Translation"),
            ("landmark_m", "model", "Model"),
        )
    ]
