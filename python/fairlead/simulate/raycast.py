# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What a surface hides: rays from a landmark to the cameras against all triangles, docs/simulate.md eq. (17)."""

from functools import lru_cache
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float64

from fairlead.types import Points3, Vector3

Triangles = Float64[np.ndarray, "m 3 3"]
CHUNK = 2_000_000
"""Rays times triangles that are tried at once: about 100 MB."""
MAX_TRIANGLES = 500_000


def hidden(triangles: Triangles, point: Vector3, centres: Points3, tolerance_m: float) -> Bool[np.ndarray, "k"]:
    """Whether a triangle crosses the segment from `point` to each centre further than tolerance_m from `point`.

    Both sides of a triangle hide; a triangle that holds `point` or lies along the ray does not. With o = point,
    d = centre - o, v, a, b = vertex and edges, s = o - v, the ray o + t d meets the triangle where

        t = b.q / det, u = d.(b x s) / det, w = d.q / det;  q = s x a, det = d.(b x a)

    and u, w, u + w lie in 0..1 (Moeller and Trumbore 1997, with the products that do not hold d taken out of the loop).
    """
    v, a, b = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    s = point - v
    q, normals, across = np.cross(s, a), np.cross(b, a), np.cross(b, s)
    height = np.einsum("mi,mi->m", b, q)
    answer = np.zeros(len(centres), dtype=np.bool_)
    rows = max(1, CHUNK // max(1, len(triangles)))
    for start in range(0, len(centres), rows):
        d = centres[start : start + rows] - point
        with np.errstate(divide="ignore", invalid="ignore"):
            inverse = 1.0 / (d @ normals.T)
            t = height * inverse
            u, w = (d @ across.T) * inverse, (d @ q.T) * inverse
            near = tolerance_m / np.linalg.norm(d, axis=1, keepdims=True)
            hit = (u >= 0.0) & (w >= 0.0) & (u + w <= 1.0) & (t > near) & (t < 1.0)
        answer[start : start + rows] = hit.any(axis=1)
    return answer


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
