# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Exact truth by ray casting, independent of every renderer: what a camera sees. docs/rendering.md section 3."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from fairlead import geometry
from fairlead.cameras import project, unproject
from fairlead.render.errors import RenderError
from fairlead.render.surface import Surface
from fairlead.types import Camera, Matrix4, Points3, Vector3

HIDDEN_TOLERANCE = 4e-3
"""A landmark is hidden by a surface that is nearer by more than this share of the diameter (frigate: 0.6 m).

Less belongs to the part that the landmark marks: the end of a yard is still seen from behind. Over random
views of the frigate, what hides a landmark does so by metres: docs/rendering.md section 3.
"""

DepthImage = Float64[np.ndarray, "h w"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Hits:
    """First face on each ray; -1 and infinity where there is none."""

    faces: Int64[np.ndarray, "n"]
    distances: Float64[np.ndarray, "n"]
    """From the origin of the ray [m]."""


class RayCaster:
    """Rays against one surface, in its own axes. Raises RenderError where embreex is not installed."""

    def __init__(self, surface: Surface) -> None:
        try:
            from embreex import rtcore_scene
            from embreex.mesh_construction import TriangleMesh
        except ImportError as error:
            raise RenderError("embreex is not installed: pip install 'fairlead[render]'") from error
        self.surface = surface
        low, high = surface.corners
        self._centre = 0.5 * (low + high)
        self._radius = 0.51 * surface.diameter
        self._scene = rtcore_scene.EmbreeScene()  # pyright: ignore[reportAttributeAccessIssue]
        corners = surface.vertices[surface.faces]
        self._origin = corners[:, 0]
        self._normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        centred = (surface.vertices - self._centre).astype(np.float32)
        TriangleMesh(self._scene, centred, surface.faces.astype(np.int32))

    def cast(self, origins: Points3, directions: Points3) -> Hits:
        """First hit of each ray; directions are unit vectors.

        Rays start where they enter the sphere about the surface, so that single precision costs 1e-7 of its diameter
        whatever the range is; the distance is then that of the plane of the face, in double precision.
        """
        skipped = np.maximum(((self._centre - origins) * directions).sum(axis=1) - self._radius, 0.0)
        starts = origins + skipped[:, None] * directions - self._centre
        faces = np.asarray(
            self._scene.run(starts.astype(np.float32), directions.astype(np.float32)), dtype=np.int64
        ).reshape(-1)
        hit = faces >= 0
        distances = np.full(len(origins), np.inf)
        normal = self._normal[faces[hit]]
        above = ((self._origin[faces[hit]] - origins[hit]) * normal).sum(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            plane = above / (directions[hit] * normal).sum(axis=1)
        distances[hit] = np.where(np.isfinite(plane), plane, skipped[hit])
        return Hits(faces=np.where(hit, faces, -1), distances=distances)

    def covered(self, centre: Vector3, points: Points3) -> Float64[np.ndarray, "n"]:
        """How far in front of each point the first surface lies on the ray from `centre` [m]; 0 if nothing is."""
        towards = points - centre
        ranges = np.linalg.norm(towards, axis=1)
        hits = self.cast(np.broadcast_to(centre, points.shape).copy(), towards / ranges[:, None])
        return np.maximum(ranges - hits.distances, 0.0)

    def visible(self, centre: Vector3, points: Points3) -> Bool[np.ndarray, "n"]:
        """Whether points of the surface are seen from `centre`: nothing in front of them by HIDDEN_TOLERANCE."""
        return self.covered(centre, points) <= HIDDEN_TOLERANCE * self.surface.diameter

    def depth(self, camera: Camera, T_camera_target: Matrix4) -> DepthImage:
        """z of the first surface at the centre of every pixel [m]; infinity where there is none."""
        depth = np.full((camera.height, camera.width), np.inf)
        p = geometry.transform(T_camera_target, self.surface.vertices)
        if p[:, 2].max() <= 0.0:
            return depth
        rows, columns = slice(0, camera.height), slice(0, camera.width)
        if p[:, 2].min() > 0.0:
            pixels = project(camera, p)
            if not np.isnan(pixels).any():
                low, high = np.floor(pixels.min(axis=0)).astype(int) - 1, np.ceil(pixels.max(axis=0)).astype(int) + 2
                columns = slice(max(0, low[0]), max(0, min(camera.width, high[0])))
                rows = slice(max(0, low[1]), max(0, min(camera.height, high[1])))
        v, u = (grid.ravel() for grid in np.mgrid[rows, columns])
        if u.size == 0:
            return depth
        rays = unproject(camera, np.column_stack([u, v]).astype(np.float64))
        R, t = T_camera_target[:3, :3], T_camera_target[:3, 3]
        hits = self.cast(np.tile(-R.T @ t, (len(rays), 1)), rays @ R)
        depth[v, u] = hits.distances * rays[:, 2]
        return depth
