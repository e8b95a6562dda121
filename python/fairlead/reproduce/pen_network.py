# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A landmark network that knows renders alone, on real photographs of a pen. docs/reproduce.md section 7.

Truth of the image points are the corners that the detector of tags measures, to 0.03 to 0.1 px.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fairlead import run
from fairlead.baselines.observed import observed
from fairlead.baselines.single_view import solve_view
from fairlead.config import TrackConfig
from fairlead.evaluate.alignment import align_poses, model_alignment
from fairlead.evaluate.pose import position_error_m, range_m, rotation_error_deg
from fairlead.geometry import project, transform
from fairlead.io.observations import read_views
from fairlead.progress import ProgressFactory
from fairlead.tracker import LandmarkIndex, refine
from fairlead.types import Camera, Matrix4, Target, View


@dataclass(frozen=True, kw_only=True)
class PenFound:
    """What a detector makes of the photographs. NaN where it finds too little to say."""

    photographs: int
    """In which it finds four landmarks or more."""
    found: float
    """Share of the corners that the detector of tags sees."""
    median_px: float
    mean_px: float
    """Distance from the corner, of what is found."""
    gross: float
    """Share of it that is more than 20 px off."""
    nees: float
    """Mean of e^T S^-1 e / 2, gross errors inside; 1 if the covariance is true."""
    posed: int
    """Photographs with a pose, all refined together."""
    corner_px: float
    """Root mean square of the true corners from the refined model in these poses."""
    corner_unseen_px: float
    """The same in odd photographs, each solved alone on the model refined with the even ones."""
    rotation_deg: float
    position_percent: float
    """Medians against the poses from the true corners, models aligned; position in per cent of the range."""


def look(network: Path, images: Path, pen: Path, output: Path, progress: ProgressFactory) -> list[View]:
    """What `fairlead track` finds in the photographs with a network; `pen` holds target and camera."""
    run.track(
        TrackConfig(
            source=images, target=pen / "target.toml", camera=pen / "camera.yaml", output=output, detector=str(network)
        ),
        progress,
    )
    return list(read_views(output / "observations.csv"))


def judge_pen(views: Sequence[View], corners: Sequence[View], target: Target, camera: Camera) -> PenFound:
    """Landmarks against the true corners of the same frame, then poses and model."""
    true = {view.frame: view for view in corners}
    pairs = [_paired(view, true[view.frame]) for view in views if view.frame in true]
    e = np.concatenate([z - z_true for z, z_true, _ in pairs])
    S = np.concatenate([told for _, _, told in pairs])
    off = np.linalg.norm(e, axis=1)
    nees = 0.5 * np.einsum("ki,kij,kj->k", e, np.linalg.inv(S), e)
    seen = [view for view in views if len(view.landmarks) >= 4 and view.frame in true]
    refined, half = refine(seen, target, camera), refine(seen[::2], target, camera).model
    posed = {
        view.frame: estimate.T_camera_target
        for view, estimate in zip(seen, refined.estimates, strict=True)
        if estimate.ok
    }
    alone = {view.frame: _pose_alone(view, half, camera) for view in seen[1::2]}
    rotation_deg, position_percent = _against(posed, refined.model, corners, target, camera)
    return PenFound(
        photographs=len(seen),
        found=len(off) / sum(len(view.landmarks) for view in corners),
        median_px=_median(off),
        mean_px=float(off.mean()) if len(off) else float("nan"),
        gross=float((off > 20.0).mean()) if len(off) else float("nan"),
        nees=float(nees.mean()) if len(off) else float("nan"),
        posed=len(posed),
        corner_px=_corner_px(posed, refined.model, true, camera),
        corner_unseen_px=_corner_px({k: T for k, T in alone.items() if T is not None}, half, true, camera),
        rotation_deg=rotation_deg,
        position_percent=position_percent,
    )


def _paired(view: View, true: View) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pixels, true pixels and covariances of the difference of what both have."""
    both = [name for name in view.landmarks if name in set(true.landmarks)]
    rows, rows_true = ([each.landmarks.index(name) for name in both] for each in (view, true))
    return view.pixels[rows], true.pixels[rows_true], view.covariances[rows] + true.covariances[rows_true]


def _pose_alone(view: View, model: Target, camera: Camera) -> Matrix4 | None:
    found = solve_view(observed(view, LandmarkIndex(model.landmarks)), model.positions, camera, refined=True)
    return None if isinstance(found, str) else found.T_camera_target


def _corner_px(poses: dict[int, Matrix4], model: Target, true: dict[int, View], camera: Camera) -> float:
    """Root mean square over the true corners of the photographs that have a pose."""
    index = LandmarkIndex(model.landmarks)
    squares = [
        ((project(camera, transform(T, model.positions[index(true[k].landmarks)])) - true[k].pixels) ** 2).sum(axis=1)
        for k, T in poses.items()
    ]
    return float(np.sqrt(np.concatenate(squares).mean())) if squares else float("nan")


def _against(
    poses: dict[int, Matrix4], model: Target, corners: Sequence[View], target: Target, camera: Camera
) -> tuple[float, float]:
    """Median rotation [deg] and position [%] against the true corners' own refinement."""
    best = refine(corners, target, camera)
    T_best = {view.frame: e.T_camera_target for view, e in zip(corners, best.estimates, strict=True) if e.ok}
    common = sorted(poses.keys() & T_best.keys())
    similarity = model_alignment(model.positions, best.model.positions, "sim3")
    if not common or similarity is None:
        return float("nan"), float("nan")
    T = align_poses(np.array([poses[k] for k in common]), similarity)
    T_true = np.array([T_best[k] for k in common])
    return _median(rotation_error_deg(T, T_true)), _median(100.0 * position_error_m(T, T_true) / range_m(T_true))


def _median(values: np.ndarray) -> float:
    return float(np.median(values)) if len(values) else float("nan")
