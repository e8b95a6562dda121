# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A mesh of any bundle of square tags, from where its corners are: what a network for it is trained on.

docs/rendering.md section 11.
"""

from collections import defaultdict
from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float64

from fairlead.opencv import marker_cells, marker_image
from fairlead.render.errors import RenderError
from fairlead.render.modelling import Modeller
from fairlead.render.surface import Material, Surface
from fairlead.types import Points3, Target, Vector3

CORNERS = ("tl", "tr", "br", "bl")
MATERIALS = (
    Material(name="ink", colour=(0.025, 0.025, 0.027), roughness=0.6),
    Material(name="paper", colour=(0.80, 0.80, 0.79), roughness=0.7),
    Material(name="body", colour=(0.10, 0.11, 0.12), roughness=0.5),
)
LIFT = 0.015
"""How high a tag lies on its body, in units of its side: the thickness of a sticker."""
PLATE = 0.1
"""Thickness of what a tag alone is glued to, in units of its side."""
HANDLE = 0.6
"""Radius of the handle in units of the side."""

_INNER = np.tile(np.linspace(0.05, 0.95, 4), (4, 1))

Quad = Float64[np.ndarray, "4 3"]
"""Corners of a tag, tl, tr, br, bl: clockwise as the upright tag is seen."""
Bits = Bool[np.ndarray, "n n"]
"""White cells of a tag, its black border included; row 0 is at the top."""


def tagged_surface(target: Target, family: str, *, quiet: float = 1.0, handle: Vector3 | None = None) -> Surface:
    """Tags whose corners are the landmarks tag<id>_tl, _tr, _br, _bl, on the body that they enclose.

    `quiet` is the width of the white margin [cells]. Tags that touch are on one body, the convex hull of their margins;
    where one of them would be inside it, every one has a plate of its own. `handle` is the end of a rod from the
    middle of the bundle [m].
    Raises RenderError: no whole tag, unknown family or identity.
    """
    tags = _tags(target)
    side = float(np.mean([np.linalg.norm(quad - np.roll(quad, 1, axis=0), axis=1) for quad in tags.values()]))
    modeller = Modeller(MATERIALS)  # in units of the side
    try:
        for identity, quad in tags.items():
            add_tag(modeller, quad / side, marker_image(family, identity, 1) > 127, quiet)
        margin = (quiet + 0.05) / marker_cells(family)
    except ValueError as error:
        raise RenderError(str(error)) from error
    _add_body(modeller, {identity: quad / side for identity, quad in tags.items()}, margin)
    if handle is not None:
        middle = np.mean([quad.mean(axis=0) for quad in tags.values()], axis=0)
        modeller.rod("body", middle / side, np.asarray(handle) / side, HANDLE, sides=16)
    surface = modeller.surface()
    return surface.with_vertices(surface.vertices * side)


def add_tag(modeller: Modeller, quad: Quad, white: Bits, quiet: float) -> None:
    """One square a cell, and the margin about them; `modeller` knows "ink" and "paper"."""
    n = len(white)
    places = np.concatenate([[-quiet], np.arange(n + 1.0), [n + quiet]]) / n
    grid = on_tag(quad, *np.meshgrid(places, places))
    cells = np.pad(white, 1, constant_values=True)
    for material, chosen in (("paper", cells), ("ink", ~cells)):
        corner = [int(r * (n + 3) + c) for r, c in np.argwhere(chosen)]
        quads = [(k, k + n + 3, k + n + 4, k + 1) for k in corner]
        modeller.polygons(material, grid.reshape(-1, 3), quads)


def on_tag(quad: Quad, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """The point u to the right and v down, in units of the side, from the corner tl; (..., 3)."""
    u, v = u[..., None], v[..., None]
    return (1.0 - v) * ((1.0 - u) * quad[0] + u * quad[1]) + v * ((1.0 - u) * quad[3] + u * quad[2])


def _tags(target: Target) -> dict[int, Quad]:
    """Corners by identity; a tag of which one is missing is left out. Raises RenderError if none is whole."""
    found: dict[int, dict[str, np.ndarray]] = defaultdict(dict)
    for name, position in zip(target.landmarks, target.positions, strict=True):
        tag, _, corner = name.rpartition("_")
        if tag.removeprefix("tag").isdigit() and tag.startswith("tag") and corner in CORNERS:
            found[int(tag.removeprefix("tag"))][corner] = position
    whole = {tag: np.stack([corners[name] for name in CORNERS]) for tag, corners in found.items() if len(corners) == 4}
    if not whole:
        raise RenderError(f"target {target.name}: expected landmarks tag<id>_tl, _tr, _br, _bl of at least one tag")
    return whole


def _add_body(modeller: Modeller, tags: Mapping[int, Quad], margin: float) -> None:
    """The convex hull of each group of tags that touch, or a plate under each; groups are joined by necks."""
    ends = np.array([-margin, 1.0 + margin])
    u, v = (each.ravel() for each in np.meshgrid(ends, ends))
    slabs = {tag: _slab(on_tag(quad, u, v), _normal(quad)) for tag, quad in tags.items()}
    groups = [np.concatenate([slabs[tag] for tag in group]) for group in _touching(slabs)]
    for group, points in zip(_touching(slabs), groups, strict=True):
        sunk = any(_sunk(points, tags[tag]) for tag in group)
        for part in [slabs[tag] for tag in group] if sunk else [points]:
            _add_hull(modeller, part)
    for first, second in pairwise(groups):
        along = second.mean(axis=0) - first.mean(axis=0)
        neck = np.concatenate([_end(first, along), _end(second, -along)])
        if not any(_sunk(neck, quad) for quad in tags.values()):
            _add_hull(modeller, neck)


def _slab(outline: Quad, normal: Vector3) -> Float64[np.ndarray, "8 3"]:
    """What a tag is glued to."""
    return np.concatenate([outline - LIFT * normal, outline - PLATE * normal])


def _touching(slabs: Mapping[int, np.ndarray]) -> list[list[int]]:
    """Tags in groups, within which one comes from each to each by steps of at most a quarter of a side."""
    groups: list[list[int]] = []
    for tag, points in slabs.items():
        near = [
            group
            for group in groups
            if any(np.linalg.norm(points[:, None] - slabs[other], axis=2).min() < 0.25 for other in group)
        ]
        groups = [group for group in groups if group not in near] + [[tag, *(each for group in near for each in group)]]
    return groups


def _end(points: Points3, along: Vector3) -> Float64[np.ndarray, "k 3"]:
    """Those that lie farthest along a direction, to a twentieth of a side."""
    far = points @ along / np.linalg.norm(along)
    return points[far > far.max() - 0.05]


def _add_hull(modeller: Modeller, points: Points3) -> None:
    """Faces as small as cells, so that a bent body and its tags bend alike."""
    import trimesh

    hull = trimesh.convex.convex_hull(points).subdivide().subdivide()
    modeller.polygons("body", np.array(hull.vertices, dtype=np.float64), np.array(hull.faces).tolist())


def _sunk(body: Points3, quad: Quad) -> bool:
    """Whether some of the tag lies below the convex hull of the points."""
    from scipy.spatial import ConvexHull

    planes = ConvexHull(body).equations
    points = on_tag(quad, _INNER, _INNER.T).reshape(-1, 3)
    return bool(((points @ planes[:, :3].T + planes[:, 3]).max(axis=1) < 0.0).any())


def _normal(quad: Quad) -> Vector3:
    """Unit, out of the printed side."""
    normal = np.cross(quad[3] - quad[0], quad[1] - quad[0])
    return normal / np.linalg.norm(normal)
