# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A surface to be rendered: triangles, and what each is made of. Target axes, metres."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float64, Int64

from fairlead.types import Points3, Vector3

Faces = Int64[np.ndarray, "m 3"]
FaceMaterials = Int64[np.ndarray, "m"]
FaceColours = Float64[np.ndarray, "m 3"]


@dataclass(frozen=True, kw_only=True)
class Material:
    """What a face looks like: linear reflectance of red, green, blue, and how rough it is."""

    name: str
    colour: tuple[float, float, float]
    """Linear reflectance [-], each 0 to 1."""
    roughness: float = 0.55
    """0 is a mirror, 1 is chalk."""

    def __post_init__(self) -> None:
        if not all(0.0 <= part <= 1.0 for part in (*self.colour, self.roughness)):
            raise ValueError(f"material {self.name}: expected colour and roughness between 0 and 1, got {self}")


@dataclass(frozen=True, kw_only=True, eq=False)
class Surface:
    """Triangles with materials. Raises ValueError for vertices, faces or materials that do not exist."""

    vertices: Points3
    """[m]."""
    faces: Faces
    """Three vertices each; seen from outside they run against the clock."""
    materials: tuple[Material, ...]
    material_of_face: FaceMaterials

    def __post_init__(self) -> None:
        if not np.isfinite(self.vertices).all():
            raise ValueError("surface: expected finite vertices")
        if len(self.faces) == 0 or len(self.material_of_face) != len(self.faces):
            raise ValueError(f"surface: expected faces with one material each, got {len(self.faces)} faces")
        if self.faces.min() < 0 or self.faces.max() >= len(self.vertices):
            raise ValueError("surface: a face names a vertex that does not exist")
        if self.material_of_face.min() < 0 or self.material_of_face.max() >= len(self.materials):
            raise ValueError("surface: a face names a material that does not exist")

    @cached_property
    def corners(self) -> tuple[Vector3, Vector3]:
        """Lowest and highest x, y, z [m]."""
        used = self.vertices[np.unique(self.faces)]
        return used.min(axis=0), used.max(axis=0)

    @cached_property
    def diameter(self) -> float:
        """Diagonal of the axis-parallel box [m]."""
        low, high = self.corners
        return float(np.linalg.norm(high - low))

    @property
    def colours(self) -> FaceColours:
        """Linear colour of each face [-]."""
        return np.array([material.colour for material in self.materials])[self.material_of_face]

    @property
    def roughness(self) -> Float64[np.ndarray, "m"]:
        """Roughness of each face [-]."""
        return np.array([material.roughness for material in self.materials])[self.material_of_face]

    def with_vertices(self, vertices: Points3) -> "Surface":
        """The same faces on other points."""
        return replace(self, vertices=vertices)

    def with_materials(self, materials: tuple[Material, ...]) -> "Surface":
        """The same faces, painted anew."""
        return replace(self, materials=materials)


def face_normals(surface: Surface) -> Float64[np.ndarray, "m 3"]:
    """Unit normals; zero for a face without area."""
    a, b, c = (surface.vertices[surface.faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return normals / np.where(lengths > 0.0, lengths, 1.0)
