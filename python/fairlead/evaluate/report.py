# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""One self-contained HTML page: no script that runs, nothing fetched, figures inline."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from fairlead.evaluate.document import evaluation_to_json
from fairlead.evaluate.evaluation import Evaluation
from fairlead.evaluate.notes import notes
from fairlead.evaluate.tables import tables
from fairlead.evaluate.tiles import main_method, tiles
from fairlead.types import Camera

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, kw_only=True)
class ReportHeader:
    """What the page says of itself. Nothing in it is computed from the clock: same runs, same page."""

    title: str
    """The target's name, usually."""
    subtitle: str = ""
    camera: Camera | None = None
    versions: tuple[tuple[str, str], ...] = ()
    """(package, version) of what ran."""
    inputs: tuple[tuple[str, str, str], ...] = ()
    """(role, file name, sha256) of what was read."""
    state: str = "done"
    """How the run ended."""


@dataclass(frozen=True, kw_only=True)
class Plate:
    """One figure on the page."""

    key: str
    """Of its caption in the template."""
    svg: str
    method: str = ""
    """Where the figure is of one method alone."""
    folded: bool = False


def write_report(path: Path, evaluations: Mapping[str, Evaluation], header: ReportHeader) -> None:
    """Write report.html; it replaces the old one at once.

    Parameters
    ----------
    path
        Where to.
    evaluations
        Method (or label of a run) -> evaluation, in the order of the columns.
    header
        Target, camera, versions.

    Raises ValueError for no evaluation.
    """
    temporary = path.with_name(f".{path.name}.part")
    temporary.write_text(render_report(evaluations, header), encoding="utf-8", newline="\n")
    temporary.replace(path)


def render_report(evaluations: Mapping[str, Evaluation], header: ReportHeader) -> str:
    """The page as text."""
    import jinja2

    from fairlead.evaluate.figures.curves import is_long
    from fairlead.evaluate.figures.style import colour_of
    from fairlead.evaluate.figures.svg import VARIABLES

    main = main_method(evaluations)
    names = list(evaluations)
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("fairlead.evaluate"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    metrics = {name: evaluation_to_json(each) for name, each in evaluations.items()}
    return environment.get_template("report.html.j2").render(
        header=header,
        main=main,
        run=evaluations[main],
        methods=names,
        failing=any(each.truth is not None and bool(each.truth.raw.failed.any()) for each in evaluations.values()),
        dense=is_long(len(evaluations[main].run.frames)),
        colours={name: VARIABLES[colour_of(name, names)] for name in names},
        tiles=tiles(evaluations),
        tables=tables(evaluations),
        plates=[plate for section in _SECTIONS for plate in section(evaluations, main)],
        notes=_state(header) + notes(evaluations),
        metrics=json.dumps(metrics, ensure_ascii=True, allow_nan=False).replace("<", "\\u003c"),
    )


def _state(header: ReportHeader) -> tuple[str, ...]:
    return (
        () if header.state == "done" else (f"the run is recorded as {header.state}: what follows may be a part of it.",)
    )


def _plate(key: str, figure: "Figure | None", *, method: str = "", folded: bool = False) -> list[Plate]:
    from fairlead.evaluate.figures.svg import figure_svg

    if figure is None:
        return []
    prefix = "-".join(part for part in (key, "".join(c if c.isalnum() else "-" for c in method)) if part)
    return [Plate(key=key, svg=figure_svg(figure, prefix), method=method, folded=folded)]


def _pose_plates(evaluations: Mapping[str, Evaluation], main: str) -> list[Plate]:
    from fairlead.evaluate import figures

    ordered = [main, *(name for name in evaluations if name != main)]
    plates = _plate("errors", figures.errors_over_time(evaluations))
    for name in ordered:
        figure = figures.consistency(evaluations[name], name)
        plates += _plate("consistency", figure, method=name, folded=name != main)
    return plates


def _model_plates(evaluations: Mapping[str, Evaluation], main: str) -> list[Plate]:
    from fairlead.evaluate import figures

    del main
    raw = _plate("landmarks", figures.landmarks_before_and_after(evaluations, "raw"))
    aligned = _plate("landmarks-sim3", figures.landmarks_before_and_after(evaluations, "sim3"), folded=True)
    shifts = [] if raw else _plate("shifts", figures.landmark_shifts(evaluations))
    return shifts + raw + aligned + _plate("model", figures.model_over_time(evaluations))


def _other_plates(evaluations: Mapping[str, Evaluation], main: str) -> list[Plate]:
    from fairlead.evaluate import figures

    del main
    judged = any(each.truth is not None and each.truth.matching.n_matched for each in evaluations.values())
    return [
        *_plate("trajectory", figures.trajectory(evaluations)),
        *_plate("residuals", figures.residuals(evaluations)),
        *_plate("reprojection", figures.reprojection_over_time(evaluations), folded=judged),
    ]


_SECTIONS: tuple[Callable[[Mapping[str, Evaluation], str], list[Plate]], ...] = (
    _pose_plates,
    _model_plates,
    _other_plates,
)
