# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What is drawn over an image, as SVG in image coordinates: marks, residuals, where landmarks should be, the mesh.

SVG puts (0, 0) at the corner of the top-left pixel, this project at its centre: half a pixel is added here.
"""

from collections.abc import Mapping
from html import escape

import numpy as np

from fairlead.annotate.labels import Labels, Mark
from fairlead.annotate.solve import FrameSolution
from fairlead.annotate.surface import Surface
from fairlead.cameras import project
from fairlead.geometry import inverse, transform
from fairlead.types import Camera, Matrix4

GOOD, CARRIED, BAD, CHOSEN, GHOST, MESH = "#4ade80", "#38bdf8", "#f87171", "#fde047", "#e5e7eb", "#22d3ee"
HALF_PX = 0.5
_EDGE_PARTS = 8
"""Parts of an edge that are hidden or not each by itself."""


def draw_marks(
    labels: Labels, marks: Mapping[int, Mark], solution: FrameSolution | None, chosen: int | None, scale: float
) -> str:
    """Marks with their residuals, and rings where unmarked landmarks should be.

    `scale` is the size of an image pixel on the screen, so that what is drawn stays the same size there.
    """
    unit = 1.0 / scale
    warned = {} if solution is None else {each.number for each in solution.warnings}
    projected = {} if solution is None else solution.projected
    in_sight = frozenset[int]() if solution is None else solution.in_sight
    parts: list[str] = []
    for landmark in labels.landmarks:
        n, mark = landmark.number, marks.get(landmark.number)
        if mark is not None and not mark.hidden:
            colour = BAD if n in warned else CARRIED if mark.origin == "flow" else GOOD
            if n in projected:
                parts.append(_residual(mark, projected[n], unit, colour))
            parts.append(_cross(mark.u_px, mark.v_px, unit, colour, n == chosen))
            parts.append(_name(mark.u_px, mark.v_px, unit, CHOSEN if n == chosen else colour, landmark.name))
        elif n in projected:
            hidden = (mark is not None and mark.hidden) or n not in in_sight
            u, v = projected[n]
            parts.append(_ring(u, v, unit, n == chosen, hidden=hidden))
            if n == chosen or not hidden:
                parts.append(_name(u, v, unit, CHOSEN if n == chosen else GHOST, landmark.name))
    return "".join(parts)


def _cross(u: float, v: float, unit: float, colour: str, chosen: bool) -> str:  # noqa: FBT001
    u, v, gap, arm = u + HALF_PX, v + HALF_PX, 3.0 * unit, 9.0 * unit
    path = "".join(
        f"M{u + dx * gap:.2f} {v + dy * gap:.2f}L{u + dx * arm:.2f} {v + dy * arm:.2f}"
        for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1))
    )
    ring = _circle(u, v, 12.0 * unit, CHOSEN, "2", "") if chosen else ""
    dark = f'<path d="{path}" stroke="#000" stroke-opacity="0.55" stroke-width="4" {_STROKE}/>'
    return f'{ring}{dark}<path d="{path}" stroke="{colour}" stroke-width="2" {_STROKE}/>'


_STROKE = 'fill="none" vector-effect="non-scaling-stroke"'


def _circle(u: float, v: float, radius: float, colour: str, width: str, dashes: str) -> str:
    dashed = f' stroke-dasharray="{dashes}"' if dashes else ""
    line = f'stroke="{colour}" stroke-width="{width}"{dashed} {_STROKE}'
    return f'<circle cx="{u:.2f}" cy="{v:.2f}" r="{radius:.3f}" {line}/>'


def _ring(u: float, v: float, unit: float, chosen: bool, *, hidden: bool) -> str:  # noqa: FBT001
    colour, opacity = (CHOSEN if chosen else GHOST), ("0.35" if hidden and not chosen else "0.9")
    ring = _circle(u + HALF_PX, v + HALF_PX, 5.0 * unit, colour, "1.5", "2 2" if hidden else "")
    return f'<g opacity="{opacity}">{ring}</g>'


def _residual(mark: Mark, projected: tuple[float, float], unit: float, colour: str) -> str:
    u, v = projected[0] + HALF_PX, projected[1] + HALF_PX
    line = f"M{mark.u_px + HALF_PX:.2f} {mark.v_px + HALF_PX:.2f}L{u:.2f} {v:.2f}"
    dot = f'<circle cx="{u:.2f}" cy="{v:.2f}" r="{1.6 * unit:.3f}" fill="#fff"/>'
    return f'<path d="{line}" stroke="{colour}" stroke-width="1.5" {_STROKE}/>{dot}'


def _name(u: float, v: float, unit: float, colour: str, name: str) -> str:
    x, y, size = u + HALF_PX + 11.0 * unit, v + HALF_PX - 8.0 * unit, 12.0 * unit
    halo = f"paint-order:stroke;stroke:#000;stroke-opacity:0.7;stroke-width:{3.0 * unit:.3f}px"
    style = f"font:600 {size:.3f}px sans-serif;{halo}"
    return f'<text x="{x:.2f}" y="{y:.2f}" fill="{colour}" style="{style}">{escape(name)}</text>'


def draw_mesh(surface: Surface, camera: Camera, T_camera_target: Matrix4) -> str:
    """The sharp edges and the outline of the mesh, where nothing of it hides them."""
    eye = inverse(T_camera_target)[:3, 3]
    facing = np.einsum("mi,mi->m", surface.normals, eye - surface.triangles[:, 0]) > 0.0
    ends = surface.vertices[surface.edges.ends]
    ends = ends[facing[surface.edges.faces].any(axis=1)]
    steps = np.linspace(0.0, 1.0, _EDGE_PARTS + 1)
    points = ends[:, None, 0] + steps[None, :, None] * (ends[:, None, 1] - ends[:, None, 0])
    pixels = project(camera, transform(T_camera_target, points.reshape(-1, 3))).reshape(*points.shape[:2], 2)
    middles = 0.5 * (points[:, 1:] + points[:, :-1])
    seen = np.ones(middles.shape[:2], dtype=np.bool_)
    if surface.fast is not None:
        seen = surface.seen_from(eye, middles.reshape(-1, 3)).reshape(middles.shape[:2])
    seen &= np.isfinite(pixels[:, 1:]).all(axis=2) & np.isfinite(pixels[:, :-1]).all(axis=2)
    begins, stops = seen.copy(), seen.copy()
    begins[:, 1:] &= ~seen[:, :-1]
    stops[:, :-1] &= ~seen[:, 1:]
    runs = zip((pixels[:, :-1][begins] + HALF_PX).tolist(), (pixels[:, 1:][stops] + HALF_PX).tolist(), strict=True)
    path = "".join(f"M{a[0]:.1f} {a[1]:.1f}L{b[0]:.1f} {b[1]:.1f}" for a, b in runs)
    return f'<path d="{path}" stroke="{MESH}" stroke-opacity="0.75" stroke-width="1" {_STROKE}/>'
