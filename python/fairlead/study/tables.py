# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The lines of a study as one wide CSV and as Markdown for people."""

import csv
from collections.abc import Callable, Sequence
from pathlib import Path

from fairlead.config import StudyKind
from fairlead.study.methods import METHODS
from fairlead.study.scores import ERRORS
from fairlead.study.summary import COMPARED_WITH, RESAMPLES, Line

_LABELS = {method.name: method.label for method in METHODS}
_OURS = ("map", "online")


def write_csv(path: Path, lines: Sequence[Line]) -> Path:
    """One row per setting and method, every number."""
    rows = [_flat(line) for line in lines]
    columns = list(dict.fromkeys(name for row in rows for name in row))
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, columns, restval="")
        writer.writeheader()
        for row in rows:
            writer.writerow({name: f"{v:.6g}" if isinstance(v, float) else v for name, v in row.items()})
    return path


def _flat(line: Line) -> dict[str, object]:
    setting = line.setting
    row: dict[str, object] = {
        "setting": setting.name,
        "sigma_px": setting.sigma_px,
        "angle_deg": setting.angle_deg,
        "model_sigma_m": setting.model_sigma_m,
        "outlier_fraction": setting.outlier_fraction,
        "views": setting.views,
        "method": line.method,
        "runs": line.statistics["iterations"].runs or line.statistics["milliseconds"].runs,
    }
    for name, statistic in line.statistics.items():
        row[name] = statistic.mean
        row[f"{name}_median"] = statistic.median
        row[f"{name}_low95"], row[f"{name}_high95"] = statistic.low, statistic.high
    for (other, error), comparison in line.against.items():
        row[f"{error}_over_{other}"] = comparison.ratio
        row[f"{error}_over_{other}_low95"], row[f"{error}_over_{other}_high95"] = comparison.low, comparison.high
    return row | {f"{name}_over_bound": ratio for name, ratio in line.bound_ratio.items()}


def write_markdown(path: Path, kind: StudyKind, lines: Sequence[Line]) -> Path:
    """Errors, comparisons, consistency and cost, each a table."""
    parts = [f"# Study: {kind}", _explanation(lines)]
    for error, title in zip(ERRORS, ("Rotation [deg]", "Translation [m]", "Model [m]"), strict=True):
        parts += [f"## {title}: mean, and 95 % interval", _table(lines, _interval(error))]
    parts += ["## Medians: rotation [deg] / translation [m] / model [m]", _table(lines, _medians)]
    parts += ["## Failures: share without a pose / with a useless one or none [%]", _table(lines, _failures)]
    parts += ["## Failed views counted with their limits: rotation [deg] / translation [m]", _table(lines, _penalised)]
    parts += ["## Ours over the others, mean of all runs [-]", _comparisons(lines)]
    parts += ["## NEES per degree of freedom: poses / model", _table(lines, _nees)]
    parts += ["## Rms over the bound: rotation / translation / model", _table(lines, _bound_ratio)]
    parts += ["## Iterations / processor time [ms] of a run", _table(lines, _cost)]
    path.write_text("\n\n".join(parts) + "\n", encoding="utf-8")
    return path


def _explanation(lines: Sequence[Line]) -> str:
    runs = sorted({line.statistics["milliseconds"].runs for line in lines})
    span = f"{runs[0]}" if runs[0] == runs[-1] else f"{runs[0]} to {runs[-1]}"
    return (
        f"{span} runs a setting. Means are over the views that have a pose, then over runs; the share without one is "
        f"below. Intervals: percentile bootstrap of the runs, {RESAMPLES} resamples. The bound's errors are those of "
        "an estimator whose errors are Gaussian with the least covariance. In the comparison, bold is what is not "
        "below 1 by its interval."
    )


def _table(lines: Sequence[Line], cell: Callable[[Line], str]) -> str:
    """Settings down, methods across; methods without any number are left out."""
    settings = list(dict.fromkeys(line.setting.name for line in lines))
    cells = {(line.setting.name, line.method): cell(line) for line in lines}
    methods = [m for m in dict.fromkeys(line.method for line in lines) if any(cells.get((s, m)) for s in settings)]
    head = ["setting", *(_LABELS[method] for method in methods)]
    rows = [[setting, *(cells.get((setting, method), "") for method in methods)] for setting in settings]
    return "\n".join("| " + " | ".join(row) + " |" for row in (head, ["---"] * len(head), *rows))


def _interval(error: str) -> Callable[[Line], str]:
    def cell(line: Line) -> str:
        s = line.statistics[error]
        if not s.runs:
            return ""
        return f"{s.mean:.3g}" if line.method == "bound" else f"{s.mean:.3g} ({s.low:.3g}-{s.high:.3g})"

    return cell


def _joined(values: Sequence[float], form: str = ".3g") -> str:
    """Numbers with slashes; nothing if none of them is known."""
    if all(value != value for value in values):
        return ""
    return " / ".join("-" if value != value else format(value, form) for value in values)


def _medians(line: Line) -> str:
    return "" if line.method == "bound" else _joined([line.statistics[error].median for error in ERRORS])


def _failures(line: Line) -> str:
    return _joined([100.0 * line.statistics[name].mean for name in ("without_pose", "failed")], ".2g")


def _penalised(line: Line) -> str:
    return _joined([line.statistics[name].mean for name in ("rotation_penalised_deg", "translation_penalised_m")])


def _nees(line: Line) -> str:
    return _joined([line.statistics[name].mean for name in ("pose_nees", "landmark_nees")])


def _bound_ratio(line: Line) -> str:
    return "" if line.method == "bound" else _joined(list(line.bound_ratio.values()))


def _cost(line: Line) -> str:
    return _joined([line.statistics["iterations"].mean, line.statistics["milliseconds"].median])


def _comparisons(lines: Sequence[Line]) -> str:
    """Rows: setting, ours, theirs; the ratio of each error with its interval, bold where it is not below 1."""
    head = ["setting", "ours", "other", "rotation", "translation", "model"]
    rows: list[list[str]] = []
    for line in lines:
        for other in COMPARED_WITH if line.method in _OURS else ():
            if (other, ERRORS[0]) in line.against:
                pairs = [line.against[other, error] for error in ERRORS]
                cells = [f"{pair.ratio:.3f} ({pair.low:.3f}-{pair.high:.3f})" for pair in pairs]
                marked = [f"**{c}**" if not pair.high < 1.0 else c for c, pair in zip(cells, pairs, strict=True)]
                rows.append([line.setting.name, line.method, other, *marked])
    return "\n".join("| " + " | ".join(row) + " |" for row in (head, ["---"] * len(head), *rows))
