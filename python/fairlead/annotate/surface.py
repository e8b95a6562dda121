# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The mesh as annotation needs it: its sharp edges, what it hides, the nearest point on it."""

import hashlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, cast

import numpy as np
from jaxtyping import Bool, Float64, Int64

from fairlead.io.documents import describe_os_error
from fairlead.io.errors import InputError
from fairlead.raycast import MAX_TRIANGLES, hidden
from fairlead.types import Points3, Vector3

SUFFIXES = (".ply", ".obj", ".stl", ".glb", ".gltf")
SHARP_RAD = np.radians(25.0)
"""Faces that turn by more meet in an edge that can be seen [rad]."""
TOLERANCE = 1.0 / 300.0
"""A surface hides nothing this near to a point on it, in units of its size [-]."""
MAX_BYTES = 1024 * 1024 * 1024


@dataclass(frozen=True, kw_only=True, eq=False)
class Surface:
    """Triangles in metres, target frame."""

    path: Path
    sha256: str
    vertices: Points3
    """Different points only."""
    faces: Int64[np.ndarray, "m 3"]
    glb: bytes
    """The same for a browser, with its colours."""

    @property
    def size_m(self) -> float:
        """Diagonal of the bounding box [m]."""
        return float(np.linalg.norm(np.ptp(self.vertices, axis=0)))

    @property
    def middle(self) -> Vector3:
        """Of the bounding box [m]."""
        return 0.5 * (self.vertices.min(axis=0) + self.vertices.max(axis=0))

    @cached_property
    def triangles(self) -> Float64[np.ndarray, "m 3 3"]:
        """Corner points of each face [m]."""
        return self.vertices[self.faces]

    @cached_property
    def normals(self) -> Points3:
        """Unit normal of each face; 0 for a face without area."""
        n = np.cross(self.triangles[:, 1] - self.triangles[:, 0], self.triangles[:, 2] - self.triangles[:, 0])
        return n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300)

    @cached_property
    def edges(self) -> "Edges":
        """The sharp ones, and the rims of open surfaces."""
        return _sharp_edges(self.faces, self.normals)

    def seen_from(
        self, centre: Vector3, points: Points3, off_m: Float64[np.ndarray, "k"] | float = 0.0
    ) -> Bool[np.ndarray, "k"]:
        """Whether nothing of the surface lies between `centre` and each point, which may be `off_m` off the surface."""
        rays = points - centre
        lengths = np.linalg.norm(rays, axis=1)
        reach = lengths - np.maximum(TOLERANCE * self.size_m, off_m)
        if self.fast is not None:
            starts = np.broadcast_to(centre, rays.shape)
            hits, ray, _ = self.fast.intersects_location(starts, rays, multiple_hits=False)
            first = np.full(len(rays), np.inf)
            first[ray] = np.linalg.norm(hits - centre, axis=1)
            return first >= reach
        nearly = np.maximum(reach / np.maximum(lengths, 1e-300), 0.0)[:, None]
        return ~hidden(self.triangles, centre, centre + nearly * rays, 0.0)

    @cached_property
    def fast(self) -> Any:
        """Embree's ray caster where it is installed, else None."""
        import trimesh

        if not trimesh.ray.has_embree:
            return None
        mesh = trimesh.Trimesh(self.vertices, self.faces, process=False)
        return trimesh.ray.ray_pyembree.RayMeshIntersector(mesh)

    def nearest(self, point: Vector3) -> Vector3:
        """The point of the surface that is nearest."""
        from trimesh.triangles import closest_point

        found = np.asarray(closest_point(self.triangles, np.tile(point, (len(self.faces), 1))))
        return found[np.argmin(np.linalg.norm(found - point, axis=1))]

    def distance_m(self, points: Points3) -> Float64[np.ndarray, "n"]:
        """Of each point from the surface [m]; points asked for before cost nothing."""
        return np.array([self._distance_of(point) for point in points], dtype=np.float64)

    def _distance_of(self, point: Vector3) -> float:
        key = point.tobytes()
        if key not in self._distances:
            self._distances[key] = float(np.linalg.norm(self.nearest(point) - point))
        return self._distances[key]

    @cached_property
    def _distances(self) -> dict[bytes, float]:
        return {}

    def first_hit(self, start: Vector3, towards: Vector3) -> Vector3 | None:
        """Where the ray from `start` through `towards` first meets the surface; None if it misses."""
        d = towards - start
        v, a, b = self.triangles[:, 0], *(self.triangles[:, i] - self.triangles[:, 0] for i in (1, 2))
        across = np.cross(d, b)
        with np.errstate(divide="ignore", invalid="ignore"):
            inverse = 1.0 / np.einsum("mi,mi->m", a, across)
            s = start - v
            u = np.einsum("mi,mi->m", s, across) * inverse
            q = np.cross(s, a)
            w, t = (q @ d) * inverse, np.einsum("mi,mi->m", b, q) * inverse
            t = np.where((u >= 0.0) & (w >= 0.0) & (u + w <= 1.0) & (t > 0.0), t, np.inf)
        first = float(t.min(initial=np.inf))
        return start + first * d if np.isfinite(first) else None


@dataclass(frozen=True, kw_only=True, eq=False)
class Edges:
    """Edges that can be seen."""

    ends: Int64[np.ndarray, "e 2"]
    """Numbers of vertices."""
    faces: Int64[np.ndarray, "e 2"]
    """The two faces that meet; twice the same at a rim."""
    turns_rad: Float64[np.ndarray, "e"]
    """By how much the surface turns there; pi at a rim."""


def _sharp_edges(faces: Int64[np.ndarray, "m 3"], normals: Points3) -> Edges:
    ends = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    owner = np.repeat(np.arange(len(faces)), 3)
    unique, first, inverse, counts = np.unique(ends, axis=0, return_index=True, return_inverse=True, return_counts=True)
    other = owner[first].copy()
    other[inverse.ravel()] = owner  # the last face that has the edge
    cosines = np.einsum("ei,ei->e", normals[owner[first]], normals[other])
    turns = np.where(counts == 1, np.pi, np.arccos(np.clip(cosines, -1.0, 1.0)))
    kept = turns > SHARP_RAD
    pairs = np.column_stack([owner[first], other]).astype(np.int64)
    return Edges(ends=unique[kept].astype(np.int64), faces=pairs[kept], turns_rad=turns[kept])


def _linearise(visual: Any) -> None:
    """Colours by face or vertex are sRGB in files; glTF wants them linear (IEC 61966-2-1)."""
    if visual.kind not in ("face", "vertex"):
        return
    colours = np.array(visual.face_colors if visual.kind == "face" else visual.vertex_colors)
    c = colours[:, :3] / 255.0
    linear = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    colours[:, :3] = np.round(255.0 * linear)
    if visual.kind == "face":
        visual.face_colors = colours
    else:
        visual.vertex_colors = colours


def _matt(tree: dict[str, Any]) -> None:
    """Matt and two-sided in a browser: glTF takes what has no material for polished metal, which is black."""
    materials = tree.setdefault("materials", [])
    for material in materials:
        material.setdefault("pbrMetallicRoughness", {}).update(metallicFactor=0.0, roughnessFactor=0.9)
        material["doubleSided"] = True
    plain = {"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.9}, "doubleSided": True}
    for primitive in (each for mesh in tree.get("meshes", []) for each in mesh["primitives"]):
        if "material" not in primitive:
            if plain not in materials:
                materials.append(plain)
            primitive["material"] = materials.index(plain)


def load_surface(path: Path, scale: float = 1.0) -> Surface:
    """Read PLY, OBJ, STL, glTF; `scale` turns its unit into metres. Raises InputError: no readable triangles."""
    import trimesh

    if path.suffix.lower() not in SUFFIXES:
        raise InputError(path, f"expected a mesh ({' '.join(SUFFIXES)})")
    try:
        if path.stat().st_size > MAX_BYTES:
            raise InputError(path, f"larger than {MAX_BYTES} bytes: no mesh for this")
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        raise InputError(path, f"cannot be read: {describe_os_error(error)}") from error
    try:
        mesh = trimesh.load(path, force="mesh", process=False)
        mesh.apply_scale(scale)  # pyright: ignore[reportAttributeAccessIssue]
        _linearise(cast(Any, mesh).visual)
        corners = np.array(mesh.triangles, dtype=np.float64)  # pyright: ignore[reportAttributeAccessIssue]
        glb = cast(Any, mesh).export(file_type="glb", tree_postprocessor=_matt)
    except Exception as error:  # any loader of trimesh may raise what it likes on a broken file
        first_line = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(path, f"no readable mesh: {first_line}") from error
    if not 0 < len(corners) <= MAX_TRIANGLES or not np.isfinite(corners).all():
        raise InputError(path, f"expected 1 to {MAX_TRIANGLES} finite triangles, got {len(corners)}")
    size = float(np.linalg.norm(np.ptp(corners.reshape(-1, 3), axis=0)))
    if not size > 0.0:
        raise InputError(path, "expected a surface, got a single point")
    _, first, inverse = np.unique(
        np.round(corners.reshape(-1, 3) / (1e-6 * size)), axis=0, return_index=True, return_inverse=True
    )
    faces = inverse.reshape(-1, 3).astype(np.int64)
    vertices = corners.reshape(-1, 3)[first]
    return Surface(path=path, sha256=digest, vertices=vertices, faces=faces, glb=bytes(glb))
