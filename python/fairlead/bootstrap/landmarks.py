# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Landmarks that were only marked: two views, then one view after the other, then all in one batch; one known distance.

docs/your-own-target.md section 4.
"""

import itertools
from collections.abc import Sequence

import numpy as np

from fairlead.bootstrap.gauge import in_own_frame, with_fixed_distance, with_scale_error
from fairlead.bootstrap.problem import BootstrapError, Bootstrapped, bootstrapped, only
from fairlead.cameras import unproject
from fairlead.geometry import inverse, transform
from fairlead.opencv import refine as refine_pose
from fairlead.opencv import relative_pose, sqpnp
from fairlead.tracker import Refinement, refine
from fairlead.types import Camera, KnownDistance, Matrix4, Points3, Rays, Target, Vector3, View

MIN_COMMON = 6
"""Landmarks that two views must share, and that a view must show to be added."""
MIN_ANGLE_RAD = np.radians(2.0)
"""Smaller angles between the lines of sight do not place a landmark [rad]."""
MAX_RMS_PX = 8.0
"""A view whose pose leaves more is not added [px]."""
PAIRS = 200
"""Pairs of views that are tried, those with most landmarks in common."""
ROUNDS = 2
PRIOR_SHARE = 0.05
"""How far each landmark may be off in the batch, as a share of the extent [-]."""

Found = dict[str, Vector3]


def bootstrap_landmarks(views: Sequence[View], camera: Camera, distance: KnownDistance, name: str) -> Bootstrapped:
    """A target of all landmarks that at least two views show, in a frame of its own.

    Origin: the centroid. x: along the known distance. z: towards the cameras. Raises BootstrapError: too few landmarks
    in common, too little difference between the views, or the two ends of the distance not among them.
    """
    seen = {each for view in views for each in view.landmarks}
    counted = {each for each in seen if sum(each in view.landmarks for view in views) >= 2}
    kept = [view for view in only(views, counted) if len(view.landmarks) >= MIN_COMMON]
    poses, X = _grow(kept, *_first_pair(kept, camera), camera)
    for end in distance.between:
        if end not in X:
            raise BootstrapError(f"the known distance ends at {end!r}, which too few views show")
    names = sorted(X)
    posed = only([view for k, view in enumerate(kept) if k in poses], set(names))
    found = _batches(posed, camera, names, np.array([X[each] for each in names]), name)
    target = _told_size(_in_own_axes(found, distance), distance)
    return bootstrapped(target, found, seen)


def _first_pair(views: list[View], camera: Camera) -> tuple[dict[int, Matrix4], Found]:
    """The two views that place most landmarks best, the first at the origin, the step between them of length 1."""
    common = {
        (i, j): [each for each in views[i].landmarks if each in views[j].landmarks]
        for i, j in itertools.combinations(range(len(views)), 2)
    }
    pairs = sorted(common, key=lambda pair: -len(common[pair]))[:PAIRS]
    best, answer = 0.0, None
    for i, j in pairs:
        names = common[i, j]
        if len(names) < MIN_COMMON:
            continue
        two = relative_pose(_pixels(views[i], names), _pixels(views[j], names), camera)
        if two is None:
            continue
        poses = {i: np.eye(4), j: two.T_b_a}
        inliers = [each for each, ok in zip(names, two.inliers, strict=True) if ok]
        X, angles = _triangulated(views, poses, inliers, camera)
        score = float(sum(min(angles[each], np.radians(25.0)) for each in X))
        if len(X) >= MIN_COMMON and score > best:
            best, answer = score, (poses, X)
    if answer is None:
        raise BootstrapError(
            f"expected two views of at least {MIN_COMMON} landmarks in common, from clearly different sides; got none"
        )
    return answer


def _pixels(view: View, names: Sequence[str]) -> np.ndarray:
    return view.pixels[[view.landmarks.index(each) for each in names]]


def _triangulated(
    views: list[View], poses: dict[int, Matrix4], names: Sequence[str], camera: Camera
) -> tuple[Found, dict[str, float]]:
    """Points nearest to all lines of sight, and the largest angle between two of them [rad]."""
    X: Found = {}
    angles: dict[str, float] = {}
    for each in names:
        seen = [k for k in poses if each in views[k].landmarks]
        if len(seen) < 2:
            continue
        rays = np.array([poses[k][:3, :3].T @ unproject(camera, _pixels(views[k], [each]))[0] for k in seen])
        eyes = np.array([inverse(poses[k])[:3, 3] for k in seen])
        point = _nearest_point(eyes, rays)
        angle = float(np.arccos(np.clip((rays @ rays.T).min(), -1.0, 1.0)))
        in_front = all(float(transform(poses[k], point[None])[0, 2]) > 0.0 for k in seen)
        if np.isfinite(point).all() and angle > MIN_ANGLE_RAD and in_front:
            X[each], angles[each] = point, angle
    return X, angles


def _nearest_point(eyes: Points3, rays: Rays) -> Vector3:
    """argmin sum_k |(I - r_k r_k^T)(X - c_k)|^2; NaN for parallel lines."""
    M = np.eye(3) - rays[:, :, None] * rays[:, None, :]
    try:
        return np.linalg.solve(M.sum(axis=0), np.einsum("kij,kj->i", M, eyes))
    except np.linalg.LinAlgError:
        return np.full(3, np.nan)


def _grow(
    views: list[View], poses: dict[int, Matrix4], known: Found, camera: Camera
) -> tuple[dict[int, Matrix4], Found]:
    """Add the view that shows most of what is known, place what it adds, until nothing can be added."""
    refused: set[int] = set()
    while True:
        shown = {
            k: [each for each in view.landmarks if each in known]
            for k, view in enumerate(views)
            if k not in poses and k not in refused
        }
        k = max(shown, key=lambda each: len(shown[each]), default=None)
        if k is None or len(shown[k]) < MIN_COMMON:
            return poses, known
        T = _pose(np.array([known[each] for each in shown[k]]), _pixels(views[k], shown[k]), camera)
        if T is None:
            refused.add(k)
            continue
        poses = {**poses, k: T}
        placed, _ = _triangulated(views, poses, sorted({each for i in poses for each in views[i].landmarks}), camera)
        known = {**known, **placed}


def _pose(X: Points3, pixels: np.ndarray, camera: Camera) -> Matrix4 | None:
    for solution in sqpnp(X, pixels, camera):
        for better in refine_pose(X, pixels, camera, solution.T_camera_target):
            if better.reprojection_rms_px < MAX_RMS_PX:
                return better.T_camera_target
    return None


def _batches(views: list[View], camera: Camera, names: list[str], X: Points3, name: str) -> Refinement:
    """All views at once; landmarks may be anywhere near where they are."""
    found: Refinement | None = None
    positions = X
    for _ in range(ROUNDS):
        sigma = PRIOR_SHARE * float(np.linalg.norm(np.ptp(positions, axis=0)))
        P0 = sigma**2 * np.eye(3 * len(positions))
        prior = Target(name=name, landmarks=tuple(names), positions=positions, covariance=P0)
        found = refine(views, prior, camera)
        positions = found.model.positions
    assert found is not None
    return found


def _in_own_axes(found: Refinement, distance: KnownDistance) -> Target:
    """Origin at the centroid, x along the distance, z towards the cameras; the frame is the model's own, eq. (5)."""
    model = found.model
    a, b = (model.landmarks.index(each) for each in distance.between)
    centre = model.positions.mean(axis=0)
    eyes = [inverse(each.T_camera_target)[:3, 3] for each in found.estimates if each.ok]
    if not eyes:
        raise BootstrapError("no view agrees with the others")
    x = model.positions[b] - model.positions[a]
    x = x / np.linalg.norm(x)
    z = np.mean(eyes, axis=0) - centre
    z = z - (z @ x) * x
    if np.linalg.norm(z) < 1e-9:
        z = np.cross(x, [0.0, 0.0, 1.0]) if abs(x[2]) < 0.9 else np.cross(x, [1.0, 0.0, 0.0])
    z = z / np.linalg.norm(z)
    R = np.stack([x, np.cross(z, x), z])
    rotation = np.kron(np.eye(len(model.landmarks)), R)
    X = (model.positions - centre) @ R.T
    P = in_own_frame(rotation @ model.covariance @ rotation.T, X)
    return Target(name=model.name, landmarks=model.landmarks, positions=X, covariance=P)


def _told_size(model: Target, distance: KnownDistance) -> Target:
    """Scaled to the known distance, whose error is that of the scale, eq. (6), (7)."""
    a, b = (model.landmarks.index(each) for each in distance.between)
    scale = distance.length_m / float(np.linalg.norm(model.positions[b] - model.positions[a]))
    X = scale * model.positions
    fixed = with_fixed_distance(scale**2 * model.covariance, X, a, b)
    P = with_scale_error(fixed, X, distance.sigma_m / distance.length_m)
    return Target(name=model.name, landmarks=model.landmarks, positions=X, covariance=P)
