# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A small workshop for parametric models: lofts, blocks, rods and balls, collected into one surface."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from fairlead.render.surface import Material, Surface
from fairlead.types import Points3

Ring = Float64[np.ndarray, "k 3"]
Point = Sequence[float] | np.ndarray


class Modeller:
    """Collects faces by material; `surface()` hands them over. Lengths in metres."""

    def __init__(self, materials: Sequence[Material]) -> None:
        self._materials = tuple(materials)
        self._index = {material.name: k for k, material in enumerate(self._materials)}
        self._vertices: list[np.ndarray] = []
        self._faces: list[np.ndarray] = []
        self._material_of_face: list[np.ndarray] = []
        self._count = 0

    def surface(self) -> Surface:
        """Everything that was added; faces without area are left out, equal vertices of a material are joined."""
        vertices, faces = np.concatenate(self._vertices), np.concatenate(self._faces)
        material = np.concatenate(self._material_of_face)
        unique, place = np.unique(np.round(vertices, 4), axis=0, return_inverse=True)
        faces = place.reshape(-1)[faces]
        a, b, c = (unique[faces[:, k]] for k in range(3))
        kept = np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-9
        return Surface(
            vertices=unique,
            faces=faces[kept].astype(np.int64),
            materials=self._materials,
            material_of_face=material[kept].astype(np.int64),
        )

    def polygons(self, material: str, points: Points3, polygons: Sequence[Sequence[int]]) -> None:
        """Convex polygons by vertex numbers, each cut into a fan."""
        fan = [(p[0], p[k], p[k + 1]) for p in polygons for k in range(1, len(p) - 1)]
        self._vertices.append(np.asarray(points, dtype=np.float64))
        self._faces.append(np.array(fan, dtype=np.int64) + self._count)
        self._material_of_face.append(np.full(len(fan), self._index[material]))
        self._count += len(points)

    def patch(self, material: str, points: Sequence[Point]) -> None:
        """One convex polygon."""
        corners = np.array(points, dtype=np.float64)
        self.polygons(material, corners, [range(len(corners))])

    def sheet(self, material: str, grid: Float64[np.ndarray, "r c 3"]) -> None:
        """A grid of points joined by quadrilaterals; normal along (next column) x (next row)."""
        rows, columns = grid.shape[:2]
        quads = [
            (r * columns + c, r * columns + c + 1, (r + 1) * columns + c + 1, (r + 1) * columns + c)
            for r in range(rows - 1)
            for c in range(columns - 1)
        ]
        self.polygons(material, grid.reshape(-1, 3), quads)

    def loft(self, material: str, rings: Sequence[Ring], *, first: bool = True, last: bool = True) -> None:
        """A skin over rings that run against the clock seen from the last; `first`, `last` close the ends."""
        n = len(rings[0])
        polygons: list[Sequence[int]] = [
            (r * n + i, r * n + (i + 1) % n, (r + 1) * n + (i + 1) % n, (r + 1) * n + i)
            for r in range(len(rings) - 1)
            for i in range(n)
        ]
        if first:
            polygons.append(range(n - 1, -1, -1))
        if last:
            polygons.append(range((len(rings) - 1) * n, len(rings) * n))
        self.polygons(material, np.concatenate(rings), polygons)

    def block(
        self,
        material: str,
        x: tuple[float, float],
        y: tuple[float, float],
        z: tuple[float, float],
        *,
        aft: float = 0.0,
        fore: float = 0.0,
        side: float = 0.0,
        chamfer: float = 0.0,
        roof: str | None = None,
    ) -> None:
        """A box whose top is drawn in by `aft`, `fore` and `side`; `chamfer` cuts its two forward edges."""
        bottom = _outline(x, y, chamfer, z[0])
        top = _outline((x[0] + aft, x[1] - fore), (y[0] + side, y[1] - side), chamfer, z[1])
        self.loft(material, [bottom, top], last=roof is None)
        if roof is not None:
            self.polygons(roof, top, [range(len(top))])

    def rod(
        self, material: str, start: Point, end: Point, radius: float, end_radius: float | None = None, sides: int = 8
    ) -> None:
        """A round bar, tapered if `end_radius` is given. Its end face has a vertex on the axis."""
        p, q = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
        along = (q - p) / np.linalg.norm(q - p)
        across = np.cross(along, (0.0, 0.0, 1.0) if abs(along[2]) < 0.9 else (1.0, 0.0, 0.0))
        across /= np.linalg.norm(across)
        angles = 2.0 * np.pi * np.arange(sides) / sides
        circle = np.outer(np.cos(angles), across) + np.outer(np.sin(angles), np.cross(along, across))
        last = q + (radius if end_radius is None else end_radius) * circle
        self.loft(material, [p + radius * circle, last], last=False)
        fan = [(i, (i + 1) % sides, sides) for i in range(sides)]
        self.polygons(material, np.concatenate([last, q[None]]), fan)

    def ball(self, material: str, centre: Point, radius: float, sides: int = 12) -> None:
        """A sphere with its poles cut off flat."""
        angles = 2.0 * np.pi * np.arange(sides) / sides
        heights = np.pi * np.arange(1, sides // 2) / (sides // 2)
        rings = [
            np.asarray(centre)
            + radius
            * np.column_stack([np.sin(h) * np.cos(angles), np.sin(h) * np.sin(angles), np.full(sides, -np.cos(h))])
            for h in heights
        ]
        self.loft(material, rings)


def _outline(x: tuple[float, float], y: tuple[float, float], chamfer: float, z: float) -> Ring:
    """Corners of a box at one height, against the clock seen from above."""
    (x0, x1), (y0, y1) = x, y
    if chamfer == 0.0:
        plan = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    else:
        plan = [(x0, y0), (x1 - chamfer, y0), (x1, y0 + chamfer), (x1, y1 - chamfer), (x1 - chamfer, y1), (x0, y1)]
    return np.array([(px, py, z) for px, py in plan])
