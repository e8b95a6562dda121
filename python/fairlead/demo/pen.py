# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""`fairlead demo pen`: a pen with eight tags, photographed by somebody else, whose drawing is wrong.

The corners were detected in 16 real photographs (data/marker_pen/README.md). Nobody surveyed where the tags really are.
"""

import time
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fairlead import run
from fairlead.baselines.observed import observed
from fairlead.baselines.single_view import solve_view
from fairlead.config import DemoConfig, RefineConfig, TrackConfig
from fairlead.evaluate import evaluate_runs
from fairlead.geometry import project, transform
from fairlead.io.camera import load_camera
from fairlead.io.observations import read_views
from fairlead.io.poses import read_poses
from fairlead.io.shipped import shipped_data
from fairlead.io.target import load_target
from fairlead.tracker import LandmarkIndex, refine
from fairlead.types import Camera, Matrix4, Pixels, Target, View

_CORNERS = ("tl", "tr", "br", "bl")


@dataclass(frozen=True, kw_only=True)
class Side:
    """Mean side of all tags of a model."""

    mean_mm: float
    sigma_mm: float
    """From the covariance of the model."""


@dataclass(frozen=True, kw_only=True)
class PenResult:
    """What the demo shows; reprojection errors are root mean squares over all corners [px]."""

    report: Path
    photographs: int
    corners: int
    drawing_px: float
    """Each photograph alone, on the drawing."""
    refined_px: float
    """Landmarks and all poses at once."""
    drawing_unseen_px: float
    """Each odd photograph alone, on the drawing."""
    refined_unseen_px: float
    """Each odd photograph alone, on the model that was refined with the even ones."""
    drawing_side: Side
    refined_side: Side
    seconds: float


def demo_pen(config: DemoConfig) -> PenResult:
    """Solve the pen, judge the result on photographs that it has not seen, write the runs and their report."""
    start_s = time.monotonic()
    folder = shipped_data("marker_pen")
    source, told, calibration = folder / "observations.csv", folder / "target.toml", folder / "camera.yaml"
    runs = {name: config.output / name for name in ("refine", "map", "epnp")}
    run.refine(RefineConfig(source=source, target=told, camera=calibration, output=runs["refine"]))
    run.track(TrackConfig(source=source, target=told, camera=calibration, output=runs["map"]))
    run.track(TrackConfig(source=source, target=told, camera=calibration, output=runs["epnp"], method="epnp"))
    target, camera, views = load_target(told), load_camera(calibration), list(read_views(source))
    refined = load_target(runs["refine"] / "target_refined.toml")
    joint = read_poses(runs["refine"] / "poses.csv")
    half = refine(views[::2], target, camera).model
    return PenResult(
        report=evaluate_runs(runs, output=config.output),
        photographs=len(views),
        corners=sum(len(view.landmarks) for view in views),
        drawing_px=_each_alone_px(views, camera, target),
        refined_px=_rms_px(views, [each.T_camera_target if each.ok else None for each in joint], camera, refined),
        drawing_unseen_px=_each_alone_px(views[1::2], camera, target),
        refined_unseen_px=_each_alone_px(views[1::2], camera, half),
        drawing_side=tag_side(target),
        refined_side=tag_side(refined),
        seconds=time.monotonic() - start_s,
    )


def _each_alone_px(views: Sequence[View], camera: Camera, model: Target) -> float:
    """Every photograph with the pose that fits it best, the landmarks being taken as exact."""
    index = LandmarkIndex(model.landmarks)
    found = [solve_view(observed(view, index), model.positions, camera, refined=True) for view in views]
    poses = [None if isinstance(each, str) else each.T_camera_target for each in found]
    return _rms_px(views, poses, camera, model)


def _rms_px(views: Sequence[View], poses: Sequence[Matrix4 | None], camera: Camera, model: Target) -> float:
    """Root mean square of |pi(T X_j) - z_j| over all corners; NaN if a photograph has no pose."""
    errors: list[Pixels] = []
    for view, T in zip(views, poses, strict=True):
        if T is None:
            return float("nan")
        X = model.positions[[model.landmarks.index(name) for name in view.landmarks]]
        errors.append(project(camera, transform(T, X)) - view.pixels)
    return float(np.sqrt(np.mean(np.sum(np.concatenate(errors) ** 2, axis=1))))


def tag_side(model: Target) -> Side:
    """Mean over the four sides of all tags [mm], and its standard deviation sqrt(g^T P g), g = d mean / d X.

    Corners are named `<tag>_tl`, `_tr`, `_br`, `_bl`.
    """
    tags: dict[str, dict[str, int]] = defaultdict(dict)
    for row, name in enumerate(model.landmarks):
        tag, _, corner = name.rpartition("_")
        tags[tag][corner] = row
    sides = [(rows[a], rows[b]) for rows in tags.values() for a, b in zip(_CORNERS, (*_CORNERS[1:], "tl"), strict=True)]
    gradient = np.zeros((len(model.landmarks), 3))
    lengths: list[float] = []
    for a, b in sides:
        edge = model.positions[b] - model.positions[a]
        lengths.append(float(np.linalg.norm(edge)))
        gradient[b] += edge / lengths[-1] / len(sides)
        gradient[a] -= edge / lengths[-1] / len(sides)
    variance = gradient.ravel() @ model.covariance @ gradient.ravel()
    return Side(mean_mm=1e3 * float(np.mean(lengths)), sigma_mm=1e3 * float(np.sqrt(variance)))
