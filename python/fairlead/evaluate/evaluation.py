# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Everything that is said of one run: a tree of frozen records, docs/metrics.md."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float64, Int64

from fairlead.evaluate.failures import Coverage, coverage
from fairlead.evaluate.history import ModelHistory, model_history, models_of_frames
from fairlead.evaluate.landmarks import ModelChange, ModelErrors, model_change, model_errors
from fairlead.evaluate.matching import TOLERANCE_NS, Matching, match_by_stamp
from fairlead.evaluate.pose_errors import PoseConsistency, PoseErrors, pose_consistency, pose_errors
from fairlead.evaluate.reprojection import Reprojection, reproject
from fairlead.evaluate.summary import Series, UpdateTime, update_time
from fairlead.evaluate.surface import SurfaceErrors, load_vertices, surface_errors
from fairlead.evaluate.trajectory import TrajectoryErrors, trajectory_errors
from fairlead.io.model_history import ModelSample
from fairlead.types import Camera, Estimate, Points3, Poses, Target, TruthPose, View


@dataclass(frozen=True, kw_only=True, eq=False)
class Run:
    """What was judged, for the figures: all frames in the order of the run."""

    frames: Int64[np.ndarray, " k"]
    stamps_ns: Int64[np.ndarray, " k"]
    seconds: Series
    """Since the first frame [s]."""
    ok: Bool[np.ndarray, " k"]
    T_camera_target: Poses
    """NaN where there is no pose."""
    target0: Target
    target_estimated: Target | None
    target_true: Target | None


@dataclass(frozen=True, kw_only=True, eq=False)
class AgainstTruth:
    """Errors of the frames whose true pose is known. Rows follow `matching.pairs`."""

    matching: Matching
    rows: Int64[np.ndarray, " k"]
    """Position in the run of each judged frame."""
    T_true: Poses
    raw: PoseErrors
    se3: PoseErrors | None
    """After moving the estimated model onto the true one; None without a true model."""
    sim3: PoseErrors | None
    consistency: PoseConsistency
    trajectory: TrajectoryErrors | None
    surface: SurfaceErrors | None


@dataclass(frozen=True, kw_only=True, eq=False)
class Evaluation:
    """Metrics of one run; what could not be computed is None."""

    run: Run
    coverage: Coverage
    truth: AgainstTruth | None
    model_before: ModelErrors | None
    """Of the model that was given, against `target_true`."""
    model_after: ModelErrors | None
    """Of the model that came out, against `target_true`."""
    model_change: ModelChange | None
    model_history: ModelHistory | None
    reprojection: Reprojection | None
    update_time: UpdateTime | None


def evaluate(
    truth: Sequence[TruthPose] | None,
    estimates: Sequence[Estimate],
    *,
    target0: Target,
    target_estimated: Target | None = None,
    target_true: Target | None = None,
    mesh: Path | Points3 | None = None,
    views: Sequence[View] | None = None,
    camera: Camera | None = None,
    timings_ms: Float64[np.ndarray, " m"] | None = None,
    models: Sequence[ModelSample] | None = None,
    tolerance_ns: int = TOLERANCE_NS,
) -> Evaluation:
    """Compare a run with what is known of the truth.

    Parameters
    ----------
    truth
        True poses; they may cover a part of the frames, or be absent.
    estimates
        One per frame, in order, those without a pose included.
    target0
        The landmark model that was given.
    target_estimated
        The model that came out; None where the method has none.
    target_true
        The true landmarks, in the frame of `truth`.
    mesh
        Surface in the target frame, file or vertices [m]: gives ADD, MSSD, MSPD.
    views, camera
        Observations and calibration: give reprojection errors.
    timings_ms
        Time of each update [ms], NaN where it was not taken.
    models
        The model while it was refined, in order of time: gives its error over time, and each frame's reprojection is
        then judged on the model of that time. Without it the last model serves all frames.
    tolerance_ns
        Largest difference of stamps between truth and estimate [ns].

    Raises ValueError for a negative tolerance, a mesh that cannot be read, or samples of another number of landmarks.
    """
    after = target0 if target_estimated is None else target_estimated
    run = _run(estimates, target0, target_estimated, target_true)
    history = None
    if models and target_true is not None:
        history = model_history(models, after.landmarks, target_true, stamps_ns=run.stamps_ns)
    errors_after = None if target_true is None else model_errors(after, target_true)
    residuals = None
    if views is not None and camera is not None:
        residuals = reproject(
            views, estimates, camera, after.landmarks, models_of_frames(estimates, target0, after, models)
        )
    return Evaluation(
        run=run,
        coverage=coverage(estimates),
        truth=None
        if truth is None
        else _against_truth(truth, estimates, run, errors_after, mesh, camera, tolerance_ns),
        model_before=None if target_true is None else model_errors(target0, target_true),
        model_after=errors_after,
        model_change=None if target_estimated is None else model_change(target0, target_estimated),
        model_history=history,
        reprojection=residuals,
        update_time=None if timings_ms is None else update_time(timings_ms),
    )


def _run(estimates: Sequence[Estimate], target0: Target, estimated: Target | None, true: Target | None) -> Run:
    stamps = [estimate.stamp_ns for estimate in estimates]
    return Run(
        frames=np.array([estimate.frame for estimate in estimates], dtype=np.int64),
        stamps_ns=np.array(stamps, dtype=np.int64),
        seconds=np.array([1e-9 * (stamp - stamps[0]) for stamp in stamps], dtype=np.float64),
        ok=np.array([estimate.ok for estimate in estimates], dtype=bool),
        T_camera_target=_stacked([estimate.T_camera_target for estimate in estimates], 4),
        target0=target0,
        target_estimated=estimated,
        target_true=true,
    )


def _against_truth(
    truth: Sequence[TruthPose],
    estimates: Sequence[Estimate],
    run: Run,
    model: ModelErrors | None,
    mesh: Path | Points3 | None,
    camera: Camera | None,
    tolerance_ns: int,
) -> AgainstTruth:
    matching = match_by_stamp(truth, estimates, tolerance_ns=tolerance_ns)
    rows = np.array([j for _, j in matching.pairs], dtype=np.int64)
    T_true = _stacked([truth[i].T_camera_target for i, _ in matching.pairs], 4)
    T = run.T_camera_target[rows]
    covariances = _stacked([estimates[j].covariance for j in rows], 6)
    ok = run.ok[rows]
    vertices = load_vertices(mesh) if isinstance(mesh, Path) else mesh
    return AgainstTruth(
        matching=matching,
        rows=rows,
        T_true=T_true,
        raw=pose_errors(T, T_true),
        se3=None if model is None or model.se3 is None else pose_errors(T, T_true, model.se3.similarity),
        sim3=None if model is None or model.sim3 is None else pose_errors(T, T_true, model.sim3.similarity),
        consistency=pose_consistency(T, T_true, covariances),
        trajectory=trajectory_errors(T[ok], T_true[ok]),
        surface=None if vertices is None else surface_errors(T, T_true, vertices, camera),
    )


def _stacked(matrices: Sequence[np.ndarray], size: int) -> np.ndarray:
    """(k, size, size), for k = 0 too."""
    return np.array(matrices, dtype=np.float64).reshape(len(matrices), size, size)
