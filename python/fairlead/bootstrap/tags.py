# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A bundle of tags that nobody surveyed: pairs of tags seen together, chained, then all views in one batch.

docs/your-own-target.md section 4.
"""

import itertools
import re
from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float64

from fairlead.bootstrap.gauge import in_own_frame, with_scale_error
from fairlead.bootstrap.problem import BootstrapError, Bootstrapped, bootstrapped, only
from fairlead.cameras import project
from fairlead.geometry import align_rigid, hat, inverse, transform
from fairlead.opencv import ippe
from fairlead.tracker import Refinement, refine
from fairlead.types import Camera, Matrix4, ModelCovariance, Pixels, Points3, Poses, Target, View

CORNERS = ("tl", "tr", "br", "bl")
PRINT_SIGMA = 0.003
"""How far each corner of a printed tag is from where it belongs, as a share of the side [-]."""
ROUNDS = ((0.1, 0.15), (0.05, 0.08), (0.05, 0.08))
"""Batches, each from tags that are squares again: how far a tag may be off (share of the bundle's extent, [rad]).

Ten times what chains of real photographs were off; where it is much more, no consensus of a view stands out.
"""
PAIR_VIEWS = 8
"""Views that a pair of tags is judged by, those where it is largest."""
BAD_PX = 20.0
"""A pair that is farther off in a view does not count as worse than this [px]."""
_TAG = re.compile(r"tag([0-9]+)_(tl|tr|br|bl)")

Square = Float64[np.ndarray, "4 3"]
"""Corners of a tag in its own frame [m]."""
Seen = dict[int, Pixels]
"""Of one view: corners of each tag that is seen whole."""


def bootstrap_tags(
    views: Sequence[View], camera: Camera, tag_size_m: float, tag_sigma_m: float, name: str
) -> Bootstrapped:
    """A target of all tags that chains of common views join, in the frame of the tag that is seen most.

    Parameters
    ----------
    views : corners named tag<id>_tl, tr, br, bl, as the tag detectors name them
    tag_size_m, tag_sigma_m : side of the black square, the same for all tags, and how well it is known [m]

    Raises BootstrapError: no tags, only one, or tags that no view joins to the others.
    """
    seen = [_whole_tags(view) for view in views]
    squares = square(tag_size_m)
    poses = [{tag: _candidates(squares, pixels, camera) for tag, pixels in each.items()} for each in seen]
    usable = [{tag: seen[k][tag] for tag, found in each.items() if found} for k, each in enumerate(poses)]
    tags = sorted({tag for each in usable for tag in each})
    if len(tags) < 2:
        raise BootstrapError(f"expected at least two tags of {tag_size_m:g} m in the views, got {len(tags)}")
    reference = max(tags, key=lambda tag: sum(len(each) for each in usable if tag in each))
    T_reference_tag = _chain(tags, reference, _pairs(usable, poses, squares, camera))
    names = [f"tag{tag}_{corner}" for tag in tags for corner in CORNERS]
    kept = only(views, set(names))
    found = _batches(kept, camera, names, np.array([T_reference_tag[tag] for tag in tags]), squares, name)
    target = _in_frame_of(found.model, squares, tags.index(reference))
    sigma = with_scale_error(
        in_own_frame(target.covariance, target.positions), target.positions, tag_sigma_m / tag_size_m
    )
    final = Target(name=name, landmarks=target.landmarks, positions=target.positions, covariance=sigma)
    return bootstrapped(final, found, {each for view in views for each in view.landmarks})


def square(side_m: float) -> Square:
    """Corners tl, tr, br, bl of a tag in its own frame: x right, y up, z out of it [m]."""
    return 0.5 * side_m * np.array([[-1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [-1.0, -1.0, 0.0]])


def _whole_tags(view: View) -> Seen:
    corners: dict[int, dict[str, np.ndarray]] = {}
    for landmark, pixel in zip(view.landmarks, view.pixels, strict=True):
        match = _TAG.fullmatch(landmark)
        if match and np.isfinite(pixel).all():
            corners.setdefault(int(match[1]), {}).setdefault(match[2], pixel)
    return {tag: np.array([found[c] for c in CORNERS]) for tag, found in corners.items() if len(found) == 4}


def _candidates(squares: Square, pixels: Pixels, camera: Camera) -> list[Matrix4]:
    """Both poses of a tag, T_camera_tag."""
    return [each.T_camera_target for each in ippe(squares, pixels, camera)]


def _pairs(
    seen: list[Seen], poses: list[dict[int, list[Matrix4]]], squares: Square, camera: Camera
) -> dict[tuple[int, int], tuple[Matrix4, float]]:
    """T_a_b of every two tags that are seen together, and its median reprojection error [px]."""
    together: dict[tuple[int, int], list[int]] = {}
    for k, each in enumerate(seen):
        for pair in itertools.combinations(sorted(each), 2):
            together.setdefault(pair, []).append(k)
    pairs: dict[tuple[int, int], tuple[Matrix4, float]] = {}
    for (a, b), all_views in together.items():
        views = sorted(all_views, key=lambda k: -min(np.ptp(seen[k][a]), np.ptp(seen[k][b])))[:PAIR_VIEWS]
        offered = np.array([inverse(T_a) @ T_b for k in views for T_a in poses[k][a] for T_b in poses[k][b]])
        back = np.array([inverse(T) for T in offered])
        errors = np.mean(
            [_off_px(poses[k][a], offered, seen[k][b], squares, camera) for k in views]
            + [_off_px(poses[k][b], back, seen[k][a], squares, camera) for k in views],
            axis=0,
        )
        best = int(np.argmin(errors))
        pairs[a, b] = (offered[best], float(errors[best]))
    return pairs


def _off_px(
    T_camera_a: list[Matrix4], T_a_b: Poses, pixels: Pixels, squares: Square, camera: Camera
) -> Float64[np.ndarray, "k"]:
    """How far b's corners are from where the better of a's poses has them, for each T_a_b, at most BAD_PX [px]."""
    T = np.array(T_camera_a)[None] @ T_a_b[:, None]
    points = np.einsum("kcij,nj->kcni", T[..., :3, :3], squares) + T[..., None, :3, 3]
    found = project(camera, points.reshape(-1, 3)).reshape(*points.shape[:3], 2)
    off = np.linalg.norm(found - pixels, axis=-1).mean(axis=-1)
    return np.minimum(np.where(np.isfinite(off), off, BAD_PX), BAD_PX).min(axis=1)


def _chain(
    tags: list[int], reference: int, pairs: Mapping[tuple[int, int], tuple[Matrix4, float]]
) -> dict[int, Matrix4]:
    """T_reference_tag along the tree of the best pairs (Prim). Raises BootstrapError for tags that nothing joins."""
    placed = {reference: np.eye(4)}
    while len(placed) < len(tags):
        joins = [(error, a, b, T) for (a, b), (T, error) in pairs.items() if (a in placed) != (b in placed)]
        if not joins:
            lone = ", ".join(str(tag) for tag in tags if tag not in placed)
            raise BootstrapError(f"tags {lone} are in no view together with the others: expected one that joins them")
        _, a, b, T = min(joins, key=lambda join: join[0])
        if a in placed:
            placed[b] = placed[a] @ T
        else:
            placed[a] = placed[b] @ inverse(T)
    return placed


def _batches(
    views: list[View], camera: Camera, names: list[str], T: np.ndarray, squares: Square, name: str
) -> Refinement:
    """All views at once, with tags that are nearly squares and lie anywhere."""
    found: Refinement | None = None
    for share, turn_rad in ROUNDS:
        X = np.concatenate([transform(each, squares) for each in T])
        prior = Target(name=name, landmarks=tuple(names), positions=X, covariance=_prior(X, squares, share, turn_rad))
        found = refine(views, prior, camera)
        fitted = [align_rigid(tag, squares) for tag in found.model.positions.reshape(-1, 4, 3)]
        for each, alignment in zip(T, fitted, strict=True):
            each[:3, :3], each[:3, 3] = alignment.R_a_b, alignment.t_a_b
    assert found is not None
    return found


def _prior(X: Points3, squares: Square, share: float, turn_rad: float) -> ModelCovariance:
    """Each tag rigid but for its print, and placed to `share` of the bundle's extent and `turn_rad`, eq. (4)."""
    side = float(np.linalg.norm(squares[1] - squares[0]))
    extent = max(float(np.linalg.norm(np.ptp(X, axis=0))), side)
    P = (PRINT_SIGMA * side) ** 2 * np.eye(3 * len(X))
    for first in range(0, len(X), 4):
        corners = X[first : first + 4]
        turn = np.concatenate([-hat(x) for x in corners - corners.mean(axis=0)])
        shift = np.tile(np.eye(3), (4, 1))
        block = slice(3 * first, 3 * first + 12)
        P[block, block] += (share * extent) ** 2 * shift @ shift.T + turn_rad**2 * turn @ turn.T
    return P


def _in_frame_of(model: Target, squares: Square, place: int) -> Target:
    """The model in the frame of its tag at this place."""
    tag = align_rigid(squares, model.positions[4 * place : 4 * place + 4])
    rotation = np.kron(np.eye(len(model.landmarks)), tag.R_a_b)
    P = rotation @ model.covariance @ rotation.T
    return Target(
        name=model.name, landmarks=model.landmarks, positions=tag.apply(model.positions), covariance=0.5 * (P + P.T)
    )
