# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures 7 and 8: noise and rendezvous angle, by `fairlead study`."""

import fnmatch
from collections.abc import Sequence as Rows

from fairlead.config import StudyConfig, StudyKind
from fairlead.reproduce import published
from fairlead.reproduce.content import Cell, Column, Picture, Section, Table
from fairlead.reproduce.context import Context
from fairlead.study.figures import draw_sensitivity, draw_sweep
from fairlead.study.methods import METHODS
from fairlead.study.recorded import core_digest
from fairlead.study.rows import read_rows, results_of
from fairlead.study.run import run_study
from fairlead.study.scores import COLUMNS
from fairlead.study.settings import VIEWS, Setting, settings_of
from fairlead.study.summary import Line, crossing, summarise

SEGMENTS_SHARE = 5
"""Segments of one flight, of up to 181 views, have so many times fewer runs."""
_OUTLIERS = "s1-a90-m1-o*"
"""Settings of the grid."""
_SHOWN = ("epnp", "single", "window", "window-5", "map", "online", "true-model", "bound")
_LABELS = {method.name: method.label for method in METHODS}
_ERRORS = (
    ("rotation_deg", "rotation", "Rotation [deg]"),
    ("translation_m", "translation", "Translation [m]"),
    ("landmark_m", "model", "Model [m]"),
)


def noise(context: Context) -> Section:
    """Figure 7."""
    lines = _lines(context, "noise", context.study_runs)
    settings = settings_of("noise")
    wild = [setting for setting in settings_of("grid") if fnmatch.fnmatchcase(setting.name, _OUTLIERS)]
    wild_lines = _lines(context, "grid", context.study_runs, _OUTLIERS)
    x = [setting.sigma_px for setting in settings]
    title = f"90 deg arc at 1 km, {VIEWS} views, model error 1 m, {context.study_runs} runs a setting"
    places = {name: _last_gain(lines, settings, x, name) for name in ("window-5", "window", "map")}
    words = (
        f"The model gains up to {_place(places['window-5'])} px of noise with the reading of the published method that "
        f"shows the published break (5 steps), up to {_place(places['window'])} px with the reading that favours it "
        f"most (2 damped steps), and up to {_place(places['map'])} px with the prior; theirs: "
        f"{published.NOISE_BREAK_PX:g} px."
    )
    return Section(
        name="noise",
        title="Figure 7: noise",
        published=published.FIGURE_7,
        words=[words],
        tables=[
            *_tables("figure7", "noise [px]", lines, settings, x),
            *_tables(
                "figure7_outliers", "share of outliers of 30 px", wild_lines, wild, [s.outlier_fraction for s in wild]
            ),
        ],
        pictures=_pictures("figure7", lines, settings, x, "noise [px]", title),
        facts={"runs a setting": str(context.study_runs)},
    )


def angle(context: Context) -> Section:
    """Figure 8: ten views at every angle, and segments of one flight."""
    runs, fewer = context.study_runs, max(context.study_runs // SEGMENTS_SHARE, 1)
    _lines(context, "angle", runs, f"*-v{VIEWS}")
    lines = _lines(context, "angle", fewer)
    tables: list[Table] = []
    pictures: list[Picture] = []
    for name, words, count, settings in (
        ("figure8", f"{VIEWS} views at every angle", runs, [s for s in settings_of("angle") if s.views == VIEWS]),
        ("figure8_segments", "one view a degree", fewer, [s for s in settings_of("angle") if s.views != VIEWS]),
    ):
        x = [setting.angle_deg for setting in settings]
        title = f"Arc at 1 km, {words}, 1 px, model error 1 m, {count} runs a setting"
        tables += _tables(name, f"angle [deg], {words}", lines, settings, x)
        pictures += _pictures(name, lines, settings, x, "angle [deg]", title)
    return Section(
        name="angle",
        title="Figure 8: rendezvous angle",
        published=published.FIGURE_8,
        words=["The publication cut segments out of one flight, so that the number of views grew with the angle."],
        tables=tables,
        pictures=pictures,
        facts={"runs a setting": f"{runs}, of segments {fewer}"},
    )


def _lines(context: Context, kind: StudyKind, runs: int, only: str = "*") -> list[Line]:
    """Do what is missing; the folder belongs to this estimator alone."""
    folder = context.cache / "studies" / f"{kind}-{core_digest()[:12]}"
    run_study(StudyConfig(study=kind, output=folder, runs=runs, only=only), context.progress)
    names = tuple(method.name for method in METHODS)
    return summarise(settings_of(kind), names, results_of(read_rows(folder), COLUMNS))


def _tables(name: str, axis: str, lines: Rows[Line], settings: Rows[Setting], x: Rows[float]) -> list[Table]:
    """One per error: settings down, methods across."""
    found = {(line.setting.name, line.method): line for line in lines}
    tables: list[Table] = []
    for error, short, title in _ERRORS:
        columns = [Column(key="x", title=axis, plain=True), *(Column(key=each, title=_LABELS[each]) for each in _SHOWN)]
        columns.append(Column(key="map_vs_epnp", title="map / EPnP's", interval=True))
        columns.append(Column(key="map_vs_window", title="map / window's", interval=True, mark="missed"))
        rows: list[dict[str, Cell]] = []
        for setting, value in zip(settings, x, strict=True):
            row: dict[str, Cell] = {"setting": setting.name, "x": value}
            for method in _SHOWN:
                row[method] = found[setting.name, method].statistics[error].mean
            for other in ("epnp", "window"):
                pair = found[setting.name, "map"].against[other, error]
                key = f"map_vs_{other}"
                row[key], row[f"{key}_low95"], row[f"{key}_high95"] = pair.ratio, pair.low, pair.high
            row["missed"] = bool(found[setting.name, "map"].against["window", error].low > 1.0)
            row["map_over_bound"] = found[setting.name, "map"].bound_ratio.get(_RMS[error], float("nan"))
            row["map_pose_nees"] = found[setting.name, "map"].statistics["pose_nees"].mean
            rows.append(row)
        tables.append(Table(name=f"{name}_{short}", title=f"{title}: mean error", columns=columns, rows=rows))
    return [*tables, _flat(name, lines, settings)]


def _flat(name: str, lines: Rows[Line], settings: Rows[Setting]) -> Table:
    """A row per setting and method; written, not shown."""
    names = {setting.name for setting in settings}
    rows: list[dict[str, Cell]] = []
    for line in lines:
        if line.setting.name in names:
            row: dict[str, Cell] = {"setting": line.setting.name, "method": line.method}
            row |= {column: statistic.mean for column, statistic in line.statistics.items()}
            row |= {f"{column}_over_bound": ratio for column, ratio in line.bound_ratio.items()}
            rows.append(row)
    return Table(name=name, title="", columns=(), rows=rows)


_RMS = {"rotation_deg": "rotation_rms_deg", "translation_m": "translation_rms_m", "landmark_m": "landmark_rms_m"}


def _pictures(
    name: str, lines: Rows[Line], settings: Rows[Setting], x: Rows[float], label: str, title: str
) -> list[Picture]:
    caption = (
        "Above: mean error, its 95 % interval, and the region that no unbiased estimator reaches. Below: in units of "
    )
    sensitivity = (
        "What the publication leaves open: start, steps and damping of its window, in units of EPnP's error. A ring "
        "is where a window becomes worse, or better, than EPnP for good."
    )
    return [
        Picture(
            name=name,
            caption=f"{caption}EPnP's on the same flights.",
            figure=draw_sweep(lines, settings, x, label, title),
        ),
        Picture(name=f"{name}_window", caption=sensitivity, figure=draw_sensitivity(lines, settings, x, label, title)),
    ]


def _last_gain(lines: Rows[Line], settings: Rows[Setting], x: Rows[float], method: str) -> float | None:
    """Up to where the model is better than the told one; None if it is everywhere."""
    found = {(line.setting.name, line.method): line for line in lines}
    ratios = [found[setting.name, method].against["epnp", "landmark_m"].ratio for setting in settings]
    if all(ratio < 1.0 for ratio in ratios):
        return None
    return crossing(x, ratios)


def _place(value: float | None) -> str:
    return "8 (all that was tried)" if value is None else f"{value:.2g}"
