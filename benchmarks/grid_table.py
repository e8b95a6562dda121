# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables of the grid: every number per cell as CSV, and what a reader wants to know as Markdown."""

import csv
from pathlib import Path

from benchmarks.cells import Cell, file_of, load_scores
from benchmarks.methods import TOLD
from benchmarks.verdicts import BOUND_RATIO, ERRORS, NEES_BAND, summarise

Line = dict[str, object]
JUDGED_SIGMA_PX = 4.0
"""Up to this noise the bound and the NEES are demanded; beyond, the posterior is no longer nearly Gaussian."""


def _lines(folder: Path, cells: list[Cell], data: str, runs: int) -> list[Line]:
    lines: list[Line] = []
    for cell in cells:
        loaded = {
            name: load_scores(file_of(folder, cell, data, name), runs) for name in ("bound", "epnp", "window", *TOLD)
        }
        bound = loaded["bound"]
        baselines = {name: scores for name in ("epnp", "window") if (scores := loaded[name]) is not None}
        for name in TOLD:
            scores = loaded[name]
            if scores is None or bound is None:
                continue
            judged = name == "map" and data == "clean" and cell.sigma_px <= JUDGED_SIGMA_PX
            head: Line = {
                "data": data,
                "sigma_px": cell.sigma_px,
                "angle_deg": cell.angle_deg,
                "model_sigma_m": cell.model_sigma_m,
            }
            lines.append(head | summarise(name, scores, baselines, bound, judge_bound=judged) | {"judged": judged})
    return lines


def _write_csv(path: Path, lines: list[Line]) -> None:
    columns = list(dict.fromkeys(key for line in lines for key in line))
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, columns)
        writer.writeheader()
        for line in lines:
            writer.writerow({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in line.items()})


def _number(line: Line, key: str) -> float:
    value = line.get(key, float("nan"))
    assert isinstance(value, float)
    return value


def _summary(lines: list[Line]) -> list[str]:
    """One row per data set and variant: how many cells meet each demand."""
    rows = [
        "| data | method | cells | not worse than EPnP | not worse than window | bound | NEES | failed views | ms |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for data, method in dict.fromkeys((str(line["data"]), str(line["method"])) for line in lines):
        mine = [line for line in lines if line["data"] == data and line["method"] == method]
        judged = [line for line in mine if line["judged"]]

        def without(part: str, some: list[Line]) -> str:
            return f"{sum(part not in str(line['misses']) for line in some)}/{len(some)}" if some else "-"

        failed = sum(_number(line, "failures") for line in mine) / len(mine)
        speed = sorted(_number(line, "milliseconds") for line in mine)[len(mine) // 2]
        rows.append(
            f"| {data} | {method} | {len(mine)} | {without('>epnp', mine)} | {without('>window', mine)} "
            f"| {without('_bound', judged)} | {without('_nees', judged)} | {100 * failed:.3f} % | {speed:.1f} |"
        )
    return rows


def _cells_table(lines: list[Line]) -> list[str]:
    """One row per cell: means of map / EPnP / window, rms over bound, NEES per dof, demands that are missed."""
    rows = [
        "| data | method | px | deg | m | rotation deg | translation m | model m | bound ratio | NEES | missed |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for line in lines:
        means = [
            " / ".join(f"{_number(line, prefix + key):.3g}" for prefix in ("", "epnp_", "window_")) for key in ERRORS
        ]
        ratios = " / ".join(f"{_number(line, key + '_bound_ratio'):.3f}" for key in ERRORS)
        nees = f"{_number(line, 'pose_nees'):.2f} / {_number(line, 'landmark_nees'):.2f}"
        rows.append(
            f"| {line['data']} | {line['method']} | {line['sigma_px']:g} | {line['angle_deg']:g} "
            f"| {line['model_sigma_m']:g} | {' | '.join(means)} | {ratios} | {nees} | {line['misses']} |"
        )
    return rows


def write_tables(folder: Path, cells: list[Cell], data_sets: list[str], runs: int) -> str:
    """Write table.csv and table.md from the scores that are there; returns the summary."""
    lines = [line for data in data_sets for line in _lines(folder, cells, data, runs)]
    summary = "\n".join(_summary(lines))
    _write_csv(folder / "table.csv", lines)
    text = (
        f"# Accuracy grid, {runs} flights per cell\n\n{summary}\n\n"
        f"Demands: mean errors not above the baseline's (paired, 99.9 % Monte Carlo error); where "
        f"sigma <= {JUDGED_SIGMA_PX:g} px and nothing wrong is told: rms <= {BOUND_RATIO:g} x bound, NEES per dof in "
        f"{NEES_BAND[0]:g} to {NEES_BAND[1]:g}. Means are map / EPnP / window.\n\n"
    )
    (folder / "table.md").write_text(text + "\n".join(_cells_table(lines)) + "\n", encoding="utf-8")
    return summary
