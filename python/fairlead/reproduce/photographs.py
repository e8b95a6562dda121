# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Real photographs: what the methods make of them. docs/reproduce.md section 8."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fairlead.baselines.epnp import EpnpTracker
from fairlead.baselines.free_window import free_batch
from fairlead.baselines.observed import observed
from fairlead.baselines.single_view import solve_view
from fairlead.demo import tag_side
from fairlead.evaluate.alignment import align_poses, model_alignment
from fairlead.evaluate.pose import position_error_m, range_m, rotation_error_deg
from fairlead.geometry import Similarity, project, transform
from fairlead.io.camera import load_camera
from fairlead.io.observations import read_views
from fairlead.io.poses import read_truth
from fairlead.io.target import load_target
from fairlead.reproduce.methods import BATCH, EPNP, ONLINE, WINDOW
from fairlead.tracker import LandmarkIndex, Tracker, refine
from fairlead.types import Camera, Estimate, PoseEstimator, Target, View

Answer = tuple[Sequence[Estimate], Target, float]
"""Estimates, the model, the median time of an update [ms]; NaN of a batch."""


@dataclass(frozen=True, kw_only=True)
class PenErrors:
    """Root mean square reprojection errors [px]."""

    joint_px: float
    """With the poses of the method, on its last model."""
    all_px: float
    """Every photograph solved alone on that model."""
    unseen_px: float
    """The odd photographs alone on a model that has seen the even ones."""
    side_mm: float
    """Mean side of the tags of the model."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TempleErrors:
    """Root mean squares against the gantry, after the similarity that aligns the model."""

    landmarks_mm: float
    landmarks_raw_mm: float
    worse: float
    """Share of the landmarks that are farther off than they were told, aligned."""
    position_percent: float
    position_late_percent: float
    rotation_deg: float
    update_ms: float
    positions_percent: np.ndarray
    """Of each photograph; NaN where there is no pose."""


def pen(folder: Path) -> dict[str, PenErrors]:
    """The drawing and three refined models."""
    target, camera = load_target(folder / "target.toml"), load_camera(folder / "camera.yaml")
    views = list(read_views(folder / "observations.csv"))
    found: dict[str, PenErrors] = {}
    for method, solve in _SOLVE.items():
        estimates, model, _ = solve(views, target, camera)
        half = solve(views[::2], target, camera)[1]
        found[method] = PenErrors(
            joint_px=_joint_px(views, estimates, camera, model),
            all_px=alone_px(views, camera, model),
            unseen_px=alone_px(views[1::2], camera, half),
            side_mm=tag_side(model).mean_mm,
        )
    return found


def temple(folder: Path) -> dict[str, TempleErrors]:
    """Every method against the gantry."""
    target, camera = load_target(folder / "target.toml"), load_camera(folder / "camera.yaml")
    true = load_target(folder / "target_true.toml")
    views = list(read_views(folder / "observations.csv"))
    poses = {pose.stamp_ns: pose.T_camera_target for pose in read_truth(folder / "truth.csv")}
    T_true = np.array([poses[view.stamp_ns] for view in views])
    return {
        method: _against_gantry(solve(views, target, camera), target, true, T_true) for method, solve in _SOLVE.items()
    }


def _against_gantry(answer: Answer, told: Target, true: Target, T_true: np.ndarray) -> TempleErrors:
    estimates, model, update_ms = answer
    similarity = _similarity(model, true)
    T = align_poses(np.array([each.T_camera_target for each in estimates]), similarity)
    percent = 100.0 * position_error_m(T, T_true) / range_m(T_true)
    after = np.linalg.norm(similarity.apply(model.positions) - true.positions, axis=1)
    before = np.linalg.norm(_similarity(told, true).apply(told.positions) - true.positions, axis=1)
    return TempleErrors(
        landmarks_mm=1e3 * _rms(after),
        landmarks_raw_mm=1e3 * _rms(np.linalg.norm(model.positions - true.positions, axis=1)),
        worse=float((after > before).mean()),
        position_percent=_rms(percent),
        position_late_percent=_rms(percent[len(percent) // 2 :]),
        rotation_deg=_rms(rotation_error_deg(T, T_true)),
        update_ms=update_ms,
        positions_percent=percent,
    )


def _similarity(model: Target, true: Target) -> Similarity:
    similarity = model_alignment(model.positions, true.positions, "sim3")
    assert similarity is not None  # neither model is a line
    return similarity


def alone_px(views: Sequence[View], camera: Camera, model: Target) -> float:
    """Every photograph with the pose that fits it best on the model; NaN if one has none."""
    index = LandmarkIndex(model.landmarks)
    squares: list[np.ndarray] = []
    for view in views:
        found = solve_view(observed(view, index), model.positions, camera, refined=True)
        if isinstance(found, str):
            return float("nan")
        X = model.positions[index(view.landmarks)]
        squares.append(((project(camera, transform(found.T_camera_target, X)) - view.pixels) ** 2).sum(axis=1))
    return float(np.sqrt(np.concatenate(squares).mean()))


def _joint_px(views: Sequence[View], estimates: Sequence[Estimate], camera: Camera, model: Target) -> float:
    """With the poses that there are; NaN if one is missing."""
    index = LandmarkIndex(model.landmarks)
    squares = [
        ((project(camera, transform(e.T_camera_target, model.positions[index(v.landmarks)])) - v.pixels) ** 2).sum(
            axis=1
        )
        for v, e in zip(views, estimates, strict=True)
    ]
    return float(np.sqrt(np.concatenate(squares).mean()))


def _online(make: Callable[[Target, Camera], PoseEstimator]) -> Callable[[Sequence[View], Target, Camera], Answer]:
    def solve(views: Sequence[View], target: Target, camera: Camera) -> Answer:
        estimator = make(target, camera)
        estimates: list[Estimate] = []
        times: list[float] = []
        for view in views:
            start_s = time.perf_counter()
            estimates.append(estimator.update(view))
            times.append(1e3 * (time.perf_counter() - start_s))
        return estimates, estimator.model, float(np.median(times))

    return solve


def _window(views: Sequence[View], target: Target, camera: Camera) -> Answer:
    found = free_batch(views, target, camera)
    return found.estimates, found.model, float("nan")


def _batch(views: Sequence[View], target: Target, camera: Camera) -> Answer:
    found = refine(views, target, camera)
    return found.estimates, found.model, float("nan")


_SOLVE: dict[str, Callable[[Sequence[View], Target, Camera], Answer]] = {
    EPNP: _online(EpnpTracker),
    WINDOW: _window,
    ONLINE: _online(Tracker),
    BATCH: _batch,
}


def _rms(values: np.ndarray) -> float:
    """NaN where one is missing: nothing is left out."""
    return float(np.sqrt((values**2).mean()))
