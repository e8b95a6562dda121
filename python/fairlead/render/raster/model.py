# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A surface on the graphics processor, and one view of it in the world."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fairlead import geometry
from fairlead.render.raster.vertices import Vertices
from fairlead.types import Camera, Matrix4, Vector3

if TYPE_CHECKING:
    import moderngl


LEAST_PX = 0.2
"""Parts thinner than this are left out of pictures (never of truth) [px]."""


class Model:
    """Vertices of one surface, and the box it fills. `programs`: painted, numbered, dark."""

    def __init__(
        self,
        context: "moderngl.Context",
        programs: Sequence["moderngl.Program"],
        vertices: Vertices,
        thickness: np.ndarray | None = None,
    ) -> None:
        self._thickness = thickness
        self.version = 0
        self._buffer = context.buffer(vertices.tobytes())
        painted = [(self._buffer, "3f 3f 4f 1f", "position", "normal", "paint", "open_sky")]
        bare = [(self._buffer, "3f 32x", "position")]
        self.painted = context.vertex_array(programs[0], painted)
        self.numbered = context.vertex_array(programs[1], bare)
        self.dark = context.vertex_array(programs[2], bare)
        self.measure(vertices)

    def repaint(self, vertices: Vertices) -> None:
        """Other colours and places on the same faces."""
        self._buffer.write(vertices.tobytes())
        self.version += 1
        self.measure(vertices)

    def release(self) -> None:
        """Give the graphics processor its memory back; the model cannot be drawn any more."""
        for part in (self.painted, self.numbered, self.dark, self._buffer):
            part.release()

    def count(self, pixels_per_m: float) -> int:
        """Vertices of the parts that are thick enough to be seen; all if their thickness is not known."""
        if self._thickness is None:
            return -1
        return 3 * int(np.searchsorted(-self._thickness, -LEAST_PX / pixels_per_m, side="right"))

    def measure(self, vertices: Vertices) -> None:
        """The box, and the colour of what a mirror near it shows."""
        places = vertices[:, :3].astype(np.float64)
        self.low, self.high = places.min(axis=0), places.max(axis=0)
        above = places[:, 2] > 0.1 * self.high[2]
        self.mean_colour = vertices[above if above.any() else slice(None), 6:9].mean(axis=0)

    @property
    def centre(self) -> Vector3:
        """Of the box [m]."""
        return 0.5 * (self.low + self.high)

    @property
    def radius(self) -> float:
        """Half the diagonal of the box [m]."""
        return 0.5 * float(np.linalg.norm(self.high - self.low))


@dataclass(frozen=True, kw_only=True, eq=False)
class Shot:
    """One view of the world. `others` are drawn too, each where its T_world_model puts it, and the wake behind the
    target, or where T_world_wake puts it.
    """

    camera: Camera
    T_camera_target: Matrix4
    T_world_target: Matrix4
    others: Sequence[tuple[Model, Matrix4]] = ()
    T_world_wake: Matrix4 | None = None

    @property
    def T_camera_world(self) -> Matrix4:
        """p_camera = T_camera_world p_world."""
        return self.T_camera_target @ geometry.inverse(self.T_world_target)

    @property
    def eye(self) -> Vector3:
        """The camera in the world [m]."""
        T = self.T_camera_world
        return -T[:3, :3].T @ T[:3, 3]
