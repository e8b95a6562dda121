# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Landmarks that are easy to find again: sharp corners, in sight from many sides, far from one another.

docs/your-own-target.md eq. (1)-(3).
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from fairlead.annotate.surface import Surface
from fairlead.types import Points3

CANDIDATES = 150
"""Corners whose visibility is found out."""
DIRECTIONS = 48
"""From which they are looked at."""
MIN_VISIBLE = 0.08
"""Share of the directions below which a corner is not offered [-]."""
_MERGE = 0.02
"""Corners nearer than this share of the target's size count as one [-]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Suggestion:
    """Points on the surface, best first."""

    positions: Points3
    """(n, 3) [m]."""
    distinctness: Float64[np.ndarray, "n"]
    """Of the corner, eq. (1) [-]."""
    visible: Float64[np.ndarray, "n"]
    """Share of directions it is seen from [-]."""


def suggest_landmarks(surface: Surface, count: int, existing: Points3) -> Suggestion:
    """Up to `count` corners, spread by farthest-point sampling, also from the `existing` landmarks, eq. (3)."""
    distinct = corner_distinctness(surface)
    candidates = _thinned(surface.vertices, distinct, _MERGE * surface.size_m)[:CANDIDATES]
    visible = visibility(surface, surface.vertices[candidates])
    kept = visible >= MIN_VISIBLE
    candidates, visible = candidates[kept], visible[kept]
    X, d = surface.vertices[candidates], distinct[candidates]
    chosen = spread_out(X, np.sqrt(d * visible), count, existing, _MERGE * surface.size_m)
    return Suggestion(positions=X[chosen], distinctness=d[chosen], visible=visible[chosen])


def corner_distinctness(surface: Surface) -> Float64[np.ndarray, "n"]:
    """lambda_2 of M = sum_e w_e d_e d_e^T over the sharp edges at each vertex, eq. (1).

    d_e is the edge's unit direction, w_e = sin(turn / 2) min(1, length / (size / 10)): 0 on a smooth surface and along
    a straight edge, 0.7 at the corner of a box.
    """
    edges = surface.edges
    along = surface.vertices[edges.ends[:, 1]] - surface.vertices[edges.ends[:, 0]]
    lengths = np.linalg.norm(along, axis=1)
    d = along / np.maximum(lengths, 1e-300)[:, None]
    w = np.sin(0.5 * edges.turns_rad) * np.minimum(1.0, lengths / (0.1 * surface.size_m))
    M = np.zeros((len(surface.vertices), 3, 3))
    outer = w[:, None, None] * d[:, :, None] * d[:, None, :]
    for end in range(2):
        np.add.at(M, edges.ends[:, end], outer)
    return np.maximum(np.linalg.eigvalsh(M)[:, 1], 0.0)


def visibility(surface: Surface, points: Points3) -> Float64[np.ndarray, "n"]:
    """Share of directions, evenly spread about the target, from which each point is in sight, eq. (2)."""
    far = 20.0 * surface.size_m
    eyes = surface.middle + far * even_directions(DIRECTIONS)
    seen = [surface.seen_from(eye, points) for eye in eyes]
    return np.mean(np.array(seen, dtype=np.float64).reshape(len(eyes), len(points)), axis=0)


def even_directions(count: int) -> Points3:
    """Unit vectors on a Fibonacci spiral about z."""
    i = np.arange(count) + 0.5
    z, angle = 1.0 - 2.0 * i / count, np.pi * (1.0 + np.sqrt(5.0)) * i
    r = np.sqrt(1.0 - z * z)
    return np.column_stack([r * np.cos(angle), r * np.sin(angle), z])


def spread_out(
    X: Points3, weights: Float64[np.ndarray, "n"], count: int, existing: Float64[np.ndarray, "there 3"], least_m: float
) -> np.ndarray:
    """Numbers of the chosen: each maximises weight x distance to the nearest that is chosen already, eq. (3)."""
    chosen: list[int] = []
    nearest = np.full(len(X), np.inf)
    for point in existing:
        nearest = np.minimum(nearest, np.linalg.norm(X - point, axis=1))
    while len(chosen) < count and len(X):
        gain = weights * np.where(np.isinf(nearest), 1.0, nearest)
        best = int(np.argmax(gain))
        if not (gain[best] > 0.0 and nearest[best] > least_m):
            break
        chosen.append(best)
        nearest = np.minimum(nearest, np.linalg.norm(X - X[best], axis=1))
    return np.array(chosen, dtype=np.int64)


def _thinned(X: Points3, score: Float64[np.ndarray, "n"], radius_m: float) -> np.ndarray:
    """Numbers of the vertices with a score, best first, none within `radius_m` of a better one."""
    left = np.flatnonzero(score > 1e-3)
    left = left[np.argsort(-score[left], kind="stable")]
    kept: list[int] = []
    while len(left):
        kept.append(int(left[0]))
        left = left[np.linalg.norm(X[left] - X[left[0]], axis=1) > radius_m]
    return np.array(kept, dtype=np.int64)
