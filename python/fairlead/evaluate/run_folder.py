# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Judge the folders that `track` and `refine` write: metrics.json, errors.csv and report.html."""

import json
import logging
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import numpy as np

from fairlead.evaluate.catalogue import metric_values
from fairlead.evaluate.document import VERSION, Json, evaluation_to_json, plain
from fairlead.evaluate.evaluation import Evaluation, evaluate
from fairlead.evaluate.matching import TOLERANCE_NS
from fairlead.evaluate.report import ReportHeader, write_report
from fairlead.evaluate.surface import load_vertices
from fairlead.evaluate.tables import write_errors
from fairlead.evaluate.tiles import main_method
from fairlead.io.camera import load_camera
from fairlead.io.documents import read_text
from fairlead.io.errors import InputError
from fairlead.io.model_history import read_model_history
from fairlead.io.observations import read_recorded_views
from fairlead.io.poses import read_poses, read_truth
from fairlead.io.run_record import RunRecord, input_file, read_run_record, write_json
from fairlead.io.target import load_target
from fairlead.io.timing import read_timing
from fairlead.types import Camera, Estimate, Points3, Target, TruthPose

_log = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True)
class JudgedRun:
    """One run folder with what was found of it."""

    record: RunRecord
    camera: Camera
    target: Target
    evaluation: Evaluation


@dataclass(frozen=True, kw_only=True, eq=False)
class KnownTruth:
    """What the runs are judged by; all of it optional."""

    poses: list[TruthPose] | None
    poses_file: Path | None
    target: Target | None
    target_file: Path | None
    vertices: Points3 | None
    tolerance_ns: int


def evaluate_run(
    run: Path,
    truth: Path | None = None,
    *,
    target_true: Path | None = None,
    mesh: Path | None = None,
    output: Path | None = None,
    tolerance_ns: int = TOLERANCE_NS,
) -> Path:
    """Judge one run folder and write metrics.json, errors.csv and report.html. Returns the report.

    Parameters
    ----------
    run
        Folder written by `fairlead track` or `fairlead refine`.
    truth
        truth.csv; without it the report tells reprojection, coverage and the change of the model.
    target_true
        target.toml with the true landmarks, in the frame of `truth`.
    mesh
        Surface in the target frame [m]; if not given, the one that the true or the given target names.
    output
        Folder for the three files; the run's own if not given.
    tolerance_ns
        Largest difference of stamps between truth and estimate [ns].

    Raises InputError for files that cannot be used, a truth of other images, or true landmarks of another target;
    nothing is written then.
    """
    label = _method(read_run_record(run / "run.json"))
    return evaluate_runs(
        {label: run},
        truth,
        target_true=target_true,
        mesh=mesh,
        output=run if output is None else output,
        tolerance_ns=tolerance_ns,
    )


def evaluate_runs(
    runs: Mapping[str, Path],
    truth: Path | None = None,
    *,
    output: Path,
    target_true: Path | None = None,
    mesh: Path | None = None,
    tolerance_ns: int = TOLERANCE_NS,
) -> Path:
    """Judge several runs of one recording side by side; `runs` maps the label of each column to its folder.

    Parameters, errors and what is written as `evaluate_run`; errors.csv is then one per run, errors_<label>.csv.
    """
    if not runs:
        raise ValueError("evaluate_runs: expected at least one run, got none")
    known = KnownTruth(
        poses=None if truth is None else read_truth(truth),
        poses_file=truth,
        target=None if target_true is None else load_target(target_true),
        target_file=target_true,
        vertices=None if mesh is None else _vertices(mesh),
        tolerance_ns=tolerance_ns,
    )
    judged = {label: _judge(folder, known) for label, folder in runs.items()}
    evaluations = {label: each.evaluation for label, each in judged.items()}
    output.mkdir(parents=True, exist_ok=True)
    write_json(output / "metrics.json", metrics_document(evaluations))
    for label, evaluation in evaluations.items():
        name = "errors.csv" if len(runs) == 1 else f"errors_{''.join(c if c.isalnum() else '_' for c in label)}.csv"
        write_errors(output / name, evaluation)
    main = main_method(evaluations)
    write_report(output / "report.html", evaluations, _header(runs[main], judged[main]))
    return output / "report.html"


def metrics_document(evaluations: Mapping[str, Evaluation]) -> dict[str, Json]:
    """Content of metrics.json: per run the table's numbers under `metrics`, everything under `evaluation`."""
    return {
        "version": VERSION,
        "runs": {
            label: {
                "metrics": {key: plain(value) for key, value in metric_values(evaluation).items()},
                "evaluation": evaluation_to_json(evaluation),
            }
            for label, evaluation in evaluations.items()
        },
    }


def _judge(run: Path, known: KnownTruth) -> JudgedRun:
    record = read_run_record(run / "run.json")
    target, camera = load_target(run / "target.toml"), load_camera(run / "camera.yaml")
    refined, history, timing = (run / name for name in ("target_refined.toml", "model_history.csv", "timing.csv"))
    observations = run / "observations.csv"
    _check_shared(run, target, known)
    estimates = read_poses(run / "poses.csv")
    vertices = known.vertices
    if vertices is None and known.poses is not None:
        vertices = _named_vertices(record, known.target or target)
    evaluation = evaluate(
        known.poses,
        estimates,
        target0=target,
        target_estimated=load_target(refined) if refined.exists() else None,
        target_true=known.target,
        mesh=vertices,
        views=list(read_recorded_views(observations)) if observations.exists() else None,
        camera=camera,
        timings_ms=np.array([each.update_ms for each in read_timing(timing)]) if timing.exists() else None,
        models=read_model_history(history, target.landmarks) if history.exists() else None,
        tolerance_ns=known.tolerance_ns,
    )
    _check_matched(run, estimates, known, evaluation)
    return JudgedRun(record=record, camera=camera, target=target, evaluation=evaluation)


def _check_shared(run: Path, target: Target, known: KnownTruth) -> None:
    """Raises InputError where the true target has none of the run's landmarks."""
    path, true = known.target_file, known.target
    if path is None or true is None or set(true.landmarks) & set(target.landmarks):
        return
    came, expected = ", ".join(true.landmarks[:4]), ", ".join(target.landmarks[:4])
    raise InputError(
        path, f"has no landmark of {run / 'target.toml'}: expected some of {expected}, ... got {came}, ..."
    )


def _check_matched(run: Path, estimates: list[Estimate], known: KnownTruth, evaluation: Evaluation) -> None:
    """Raises InputError where the truth tells of no frame of the run."""
    path, poses, against = known.poses_file, known.poses, evaluation.truth
    if path is None or poses is None or against is None or against.matching.n_matched:
        return
    ours, theirs = (_span([each.stamp_ns for each in of]) for of in (estimates, poses))
    raise InputError(path, f"tells of no frame of {run}: expected stamps_ns like {ours}, got {theirs}")


def _span(stamps_ns: list[int]) -> str:
    """First and last of the stamps [ns], and how many there are."""
    return f"{min(stamps_ns)} to {max(stamps_ns)} ({len(stamps_ns)})" if stamps_ns else "none"


def _vertices(path: Path) -> Points3:
    try:
        return load_vertices(path)
    except ValueError as error:
        raise InputError(path, str(error).removeprefix(f"{path}: ")) from error


def _named_vertices(record: RunRecord, target: Target) -> Points3 | None:
    """The mesh that a target names; that of the run's input, which the copy in the folder cannot name, if unchanged."""
    if target.mesh is not None:
        return _vertices(target.mesh)
    original = record.input_path("target")
    if original is None or not original.is_file():
        return None
    if input_file("target", original) not in record.inputs:
        _log.warning("%s has changed since the run; its mesh is not used", original)
        return None
    mesh = load_target(original).mesh
    return None if mesh is None else _vertices(mesh)


def _method(record: RunRecord) -> str:
    """map, window, epnp, or refine."""
    options = record.options
    if record.command == "track" and isinstance(options, dict):
        return str(cast(dict[str, object], options).get("method", "track"))
    return record.command


def _header(run: Path, judged: JudgedRun) -> ReportHeader:
    versions = cast(dict[str, object], json.loads(read_text(run / "run.json"))).get("versions")
    known = cast(dict[str, object], versions) if isinstance(versions, dict) else {}
    return ReportHeader(
        title=judged.target.name,
        camera=judged.camera,
        versions=tuple((package, str(version)) for package, version in known.items()),
        inputs=tuple((item.role, Path(item.path).name, item.sha256) for item in judged.record.inputs),
        state=judged.record.state,
    )
