# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The published joint optimisation of landmarks and poses without a prior, docs/baselines.md section 3.

Source: Guo, Chen, Wang, Zhang, Sun 2024, Joint Optimization of the 3D Model and 6D Pose for Monocular Pose Estimation,
Drones 8(11), 626. What the publication leaves open was chosen in its favour; docs/baselines.md has the numbers.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fairlead import _core
from fairlead.baselines.observed import Observed, observed, plain
from fairlead.baselines.single_view import SingleView, solve_view, tracked
from fairlead.tracker import LandmarkIndex, core_camera
from fairlead.types import Camera, Estimate, Matrix4, Points3, Poses, Target, View, no_pose


@dataclass(frozen=True, kw_only=True)
class FreeWindowOptions:
    """What the publication leaves open."""

    window_size: int = 20
    """Keyframes in the window [views]. More see more angle, and the first pose comes later."""
    min_turn_deg: float = 0.5
    """Turn of the viewing direction that makes a keyframe [deg]. Too small: no parallax; too large: a late start."""
    min_range_ratio: float = 1.1
    """Change of range, either way, that makes a keyframe [-]."""
    iterations: int = 2
    """Levenberg-Marquardt steps of a solve. More fit the noise: nothing but the early stop regularises."""
    initial_damping: float = 1.0
    """Of the first step, relative to the Hessian's diagonal [-]. Too small: the free directions run away."""

    def __post_init__(self) -> None:
        if self.window_size < 2 or self.iterations < 1:
            raise ValueError(f"window: expected at least 2 views and 1 iteration, got {self}")
        if not (self.min_turn_deg >= 0.0 and self.min_range_ratio >= 1.0 and self.initial_damping > 0.0):
            raise ValueError(f"window: expected a turn >= 0, a range ratio >= 1 and a damping > 0, got {self}")


@dataclass(frozen=True, kw_only=True, eq=False)
class FreeBatch:
    """What `free_batch` found."""

    estimates: tuple[Estimate, ...]
    """One per view, in order; lost where PnP found no pose."""
    model: Target
    """The target with the landmarks that the solve ended at; its covariance is that of the target told."""


def free_batch(
    views: Iterable[View], target: Target, camera: Camera, options: FreeWindowOptions | None = None
) -> FreeBatch:
    """PnP per view, landmarks and all poses together by minimising sum r^T S^-1 r, PnP per view on the result.

    docs/baselines.md eq. (2). No prior; the damping alone holds the gauge, so that steps change as little as they can.
    Raises ValueError for fewer than four landmarks in the target, or an unknown landmark in a view.
    """
    options = options or FreeWindowOptions()
    views = tuple(views)
    camera = plain(camera)
    index = LandmarkIndex(target.landmarks)
    seen = [observed(view, index) for view in views]
    first = [solve_view(one, target.positions, camera, refined=True) for one in seen]
    kept = [k for k, pose in enumerate(first) if isinstance(pose, SingleView)]
    T = np.array([pose.T_camera_target for pose in first if isinstance(pose, SingleView)]).reshape(-1, 4, 4)
    X, _ = _solve([seen[k] for k in kept], target.positions, T, camera, options)
    last = [solve_view(one, X, camera, refined=True) for one in seen]
    estimates = [_estimate(view, s, pose, target.landmarks) for view, s, pose in zip(views, seen, last, strict=True)]
    return FreeBatch(estimates=tuple(estimates), model=replace(target, positions=X))


class WindowTracker:
    """The published method: PnP on the current model, a full window of keyframes refined together, PnP on the result.

    PnP is EPnP with its reprojection error minimised from there.

    Status acquiring until the window is full for the first time; then tracking, or lost with a reason. The refined
    model is carried on as a point, in a frame that drifts: nothing holds the gauge. The covariance is that of the told
    pixel errors on an exact model, docs/baselines.md eq. (1).

    Raises ValueError for fewer than four landmarks.
    """

    def __init__(self, target: Target, camera: Camera, options: FreeWindowOptions | None = None) -> None:
        if len(target.landmarks) < 4:
            raise ValueError(f"target: expected at least 4 landmarks, got {len(target.landmarks)}")
        self._target = target
        self._camera = plain(camera)
        self._options = options or FreeWindowOptions()
        self._index = LandmarkIndex(target.landmarks)
        self._positions = target.positions
        self._seen: list[Observed] = []
        self._poses: list[Matrix4] = []
        self._was_full = False

    def update(self, view: View) -> Estimate:
        """Take in one view; bad data end in the status. ValueError for an unknown landmark only."""
        seen = observed(view, self._index)
        first = solve_view(seen, self._positions, self._camera, refined=True)
        if isinstance(first, str):
            return no_pose(view, "lost" if self._was_full else "acquiring", first)
        if self._is_keyframe(first.T_camera_target):
            self._push(seen, first.T_camera_target)
            first = solve_view(seen, self._positions, self._camera, refined=True)
        if not self._was_full:
            return no_pose(view, "acquiring", "window_not_full")
        return _estimate(view, seen, first, self._target.landmarks)

    @property
    def model(self) -> Target:
        """The target with the landmarks as they are now; its covariance stays that of the target told."""
        return replace(self._target, positions=self._positions)

    def _is_keyframe(self, T_camera_target: Matrix4) -> bool:
        if not self._poses:
            return True
        centre = self._positions.mean(axis=0)
        now, last = (-T[:3, :3].T @ T[:3, 3] - centre for T in (T_camera_target, self._poses[-1]))
        ranges = float(np.linalg.norm(now)), float(np.linalg.norm(last))
        turn = np.arctan2(np.linalg.norm(np.cross(now, last)), now @ last)
        ratio = max(ranges) / max(min(ranges), 1e-12)
        return bool(turn >= np.radians(self._options.min_turn_deg) or ratio >= self._options.min_range_ratio)

    def _push(self, seen: Observed, T_camera_target: Matrix4) -> None:
        size = self._options.window_size
        self._seen = [*self._seen, seen][-size:]
        self._poses = [*self._poses, T_camera_target][-size:]
        if len(self._poses) == size:
            self._was_full = True
            self._positions, T = _solve(self._seen, self._positions, np.array(self._poses), self._camera, self._options)
            self._poses = list(T)


def _solve(
    seen: Sequence[Observed], X_target: Points3, T: Poses, camera: Camera, options: FreeWindowOptions
) -> tuple[Points3, Poses]:
    """Landmarks seen in at least two views, and all poses, after a few damped steps; what came if that fails."""
    if len(seen) < 2:
        return X_target, T
    index = np.concatenate([one.index for one in seen])
    active = np.flatnonzero(np.bincount(index, minlength=len(X_target)) >= 2)
    number = np.full(len(X_target), -1)
    number[active] = np.arange(len(active))
    view = np.repeat(np.arange(len(seen)), [len(one.index) for one in seen])
    used = number[index] >= 0
    if np.bincount(view[used], minlength=len(seen)).min() < 4:
        return X_target, T
    X, poses, _, _, _, ok = _core.solve_window(
        core_camera(camera),
        X_target[active],
        T,
        view[used].astype(np.int32),
        number[index][used].astype(np.int32),
        np.concatenate([one.pixels for one in seen])[used],
        np.concatenate([one.covariances for one in seen])[used],
        max_iterations=options.iterations,
        initial_damping=options.initial_damping,
    )
    if not (ok and np.isfinite(X).all() and np.isfinite(poses).all()):
        return X_target, T
    refined = X_target.copy()
    refined[active] = X
    return refined, np.array(poses)


def _estimate(view: View, seen: Observed, pose: SingleView | str, landmarks: tuple[str, ...]) -> Estimate:
    if isinstance(pose, str):
        return no_pose(view, "lost", pose)
    return tracked(view, seen, pose, landmarks)
