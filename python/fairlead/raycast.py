# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What a surface hides: rays from a landmark to the cameras against all triangles, docs/simulate.md eq. (17)."""

from functools import lru_cache
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float64

from fairlead.types import Points3, Vector3

Triangles = Float64[np.ndarray, "m 3 3"]
CHUNK = 64
"""Rays of neighbouring cameras that are tried at once."""
MAX_TRIANGLES = 500_000


def hidden(triangles: Triangles, point: Vector3, centres: Points3, tolerance_m: float) -> Bool[np.ndarray, "k"]:
    """Whether a triangle crosses the segment from `point` to each centre further than tolerance_m from `point`.

    Both sides of a triangle hide; one that holds `point` or lies along the ray does not. Centres that follow one
    another are tried together, against the triangles that touch the cone about them.
    """
    middles = triangles.mean(axis=1) - point
    radii = np.linalg.norm(triangles - triangles.mean(axis=1, keepdims=True), axis=2).max(axis=1)
    distances = np.maximum(np.linalg.norm(middles, axis=1), 1e-300)
    spread = np.where(radii < distances, np.arcsin(np.minimum(radii / distances, 1.0)), np.pi)
    answer = np.zeros(len(centres), dtype=np.bool_)
    for start in range(0, len(centres), CHUNK):
        d = centres[start : start + CHUNK] - point
        unit = d / np.maximum(np.linalg.norm(d, axis=1, keepdims=True), 1e-300)
        axis = unit.mean(axis=0)
        axis /= max(float(np.linalg.norm(axis)), 1e-300)
        cone = np.arccos(np.clip(unit @ axis, -1.0, 1.0)).max()
        off = np.arccos(np.clip(middles @ axis / distances, -1.0, 1.0))
        answer[start : start + CHUNK] = _crossed(triangles[off <= cone + spread + 1e-6], point, d, tolerance_m)
    return answer


def _crossed(
    triangles: Triangles, point: Vector3, d: Float64[np.ndarray, "rays 3"], tolerance_m: float
) -> Bool[np.ndarray, "rays"]:
    """All rays against all triangles. With v, a, b = vertex and edges, s = point - v, the ray point + t d meets it at

        t = b.q / det, u = d.(b x s) / det, w = d.q / det;  q = s x a, det = d.(b x a)

    where u, w, u + w lie in 0..1 (Moeller and Trumbore 1997, what does not hold d taken out of the loop).
    """
    v, a, b = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    s = point - v
    q, normals, across = np.cross(s, a), np.cross(b, a), np.cross(b, s)
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1.0 / (d @ normals.T)
        t = np.einsum("mi,mi->m", b, q) * inverse
        u, w = (d @ across.T) * inverse, (d @ q.T) * inverse
        near = tolerance_m / np.linalg.norm(d, axis=1, keepdims=True)
        hit = (u >= 0.0) & (w >= 0.0) & (u + w <= 1.0) & (t > near) & (t < 1.0)
    return hit.any(axis=1)


@lru_cache(maxsize=16)
def visible_from(mesh: Path, tolerance_m: float, points: bytes, centres: bytes) -> Bool[np.ndarray, "k n"]:
    """Whether each of the points is in sight from each of the centres; both as bytes of float64, rows of three.

    Runs of a study often share both: the last sixteen answers are kept. Raises ValueError for a mesh that is none.
    """
    triangles = load_triangles(mesh)
    eyes = np.frombuffer(centres).reshape(-1, 3)
    columns = [~hidden(triangles, X, eyes, tolerance_m) for X in np.frombuffer(points).reshape(-1, 3)]
    seen = np.stack(columns, axis=1)
    seen.setflags(write=False)
    return seen


@lru_cache(maxsize=4)
def load_triangles(path: Path) -> Triangles:
    """Triangles of a mesh file, (m, 3, 3) [m]. Raises ValueError: one line."""
    import trimesh

    try:
        mesh = trimesh.load(path, force="mesh", process=False)
        triangles = np.array(mesh.triangles, dtype=np.float64)  # pyright: ignore[reportAttributeAccessIssue]
    except Exception as error:  # any loader of trimesh may raise what it likes on a broken file
        first_line = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ValueError(f"{path}: no readable mesh: {first_line}") from error
    if not 0 < len(triangles) <= MAX_TRIANGLES or not np.isfinite(triangles).all():
        raise ValueError(f"{path}: expected 1 to {MAX_TRIANGLES} finite triangles, got {len(triangles)}")
    triangles.setflags(write=False)
    return triangles
