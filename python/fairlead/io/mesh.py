# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Mesh files -> triangles, in metres; whatever trimesh reads."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Int64

from fairlead.io.errors import InputError
from fairlead.types import Points3

MAX_FACES = 2_000_000
"""A larger mesh is refused."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Mesh:
    """Triangles of a surface."""

    vertices: Points3
    """[m], target frame."""
    faces: Int64[np.ndarray, "m 3"]
    """Numbers of the vertices of each triangle."""


def load_mesh(path: Path) -> Mesh:
    """Read a mesh. Raises InputError: no readable triangles, or numbers that are not finite."""
    import trimesh

    try:
        read = trimesh.load(path, force="mesh", process=False)
        vertices = np.array(read.vertices, dtype=np.float64)  # pyright: ignore[reportAttributeAccessIssue]
        faces = np.array(read.faces, dtype=np.int64)  # pyright: ignore[reportAttributeAccessIssue]
    except Exception as error:  # any loader of trimesh may raise what it likes on a broken file
        first_line = (str(error).splitlines() or [type(error).__name__])[0]
        raise InputError(path, f"no readable mesh: {first_line}") from error
    if not 0 < len(faces) <= MAX_FACES:
        raise InputError(path, f"expected a mesh of 1 to {MAX_FACES} triangles, got {len(faces)}")
    if not np.isfinite(vertices).all():
        raise InputError(path, "expected finite vertices")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise InputError(path, "a triangle names a vertex that is not there")
    return Mesh(vertices=vertices, faces=faces)
