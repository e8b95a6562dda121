# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A surface as the graphics processor wants it: smooth normals, and how much of the sky each corner sees."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float32, Float64

from fairlead.render.raycast import RayCaster
from fairlead.render.surface import Surface, face_normals

CREASE_COSINE = 0.82
"""Faces that meet under less than 35 degrees are shaded as one smooth surface."""
RAYS = 24

CornerNormals = Float64[np.ndarray, "m 3 3"]
Vertices = Float32[np.ndarray, "k 11"]


def pack(surface: Surface, open_sky: Float64[np.ndarray, "m 3"] | None = None) -> Vertices:
    """position 3, normal 3, colour 3, roughness, open sky, for each corner of each face."""
    normals = corner_normals(surface)
    count = len(surface.faces)
    table = np.ones((count, 3, 11), np.float32)
    table[:, :, 0:3] = surface.vertices[surface.faces]
    table[:, :, 3:6] = normals
    table[:, :, 6:9] = surface.colours[:, None]
    table[:, :, 9] = surface.roughness[:, None]
    if open_sky is not None:
        table[:, :, 10] = open_sky
    return table.reshape(-1, 11)


def thickest_first(surface: Surface) -> tuple[Surface, Float64[np.ndarray, "m"]]:
    """The same faces, those of thick parts first, and the thickness of each face's part [m], falling.

    A part is what hangs together by edges; its thickness is twice the second largest of its principal deviations.
    """
    import trimesh

    mesh = trimesh.Trimesh(surface.vertices, surface.faces, process=False)
    part = trimesh.graph.connected_component_labels(mesh.face_adjacency, node_count=len(surface.faces))
    points, owner = surface.vertices[surface.faces].reshape(-1, 3), np.repeat(part, 3)
    count = np.bincount(owner)
    mean = np.column_stack([np.bincount(owner, points[:, k]) / count for k in range(3)])
    about = points - mean[owner]
    products = (about[:, :, None] * about[:, None, :]).reshape(-1, 9)
    spread = np.column_stack([np.bincount(owner, products[:, k]) / count for k in range(9)]).reshape(-1, 3, 3)
    thickness = (2.0 * np.sqrt(np.maximum(np.linalg.eigvalsh(spread)[:, 1], 0.0)))[part]
    order = np.argsort(-thickness, kind="stable")
    sorted_surface = replace(surface, faces=surface.faces[order], material_of_face=surface.material_of_face[order])
    return sorted_surface, thickness[order]


def corner_normals(surface: Surface) -> CornerNormals:
    """Mean of the normals of the faces that meet in a vertex and differ little, weighted by area."""
    normals = face_normals(surface)
    a, b, c = (surface.vertices[surface.faces[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    flat = surface.faces.ravel()
    owner = np.repeat(np.arange(len(normals)), 3)
    order = np.argsort(flat, kind="stable")
    starts = np.searchsorted(flat[order], np.arange(len(surface.vertices) + 1))
    sizes = np.diff(starts)
    result = np.zeros((len(flat), 3))
    for shift in range(int(sizes.max())):  # the shift-th neighbour of every corner at once
        place = starts[flat] + shift
        valid = shift < sizes[flat]
        other = owner[order[np.minimum(place, len(order) - 1)]]
        near = valid & ((normals[owner] * normals[other]).sum(axis=1) > CREASE_COSINE)
        result[near] += normals[other[near]] * area[other[near], None]
    lengths = np.linalg.norm(result, axis=1, keepdims=True)
    result = np.where(lengths > 1e-12, result / np.maximum(lengths, 1e-12), normals[owner])
    return result.reshape(-1, 3, 3)


def open_sky(caster: RayCaster, rng: np.random.Generator) -> Float64[np.ndarray, "m 3"]:
    """Share of the rays into the hemisphere over each corner, weighted by the cosine, that leave the surface.

    Rays that meet it only beyond a quarter of its diameter count as free.
    """
    surface = caster.surface
    normals = corner_normals(surface).reshape(-1, 3)
    corners = surface.vertices[surface.faces]
    inward = corners.mean(axis=1, keepdims=True) - corners
    lift = 2e-4 * surface.diameter
    places = (corners + 0.08 * inward).reshape(-1, 3)
    keys = np.round(np.concatenate([places / min(1.0, surface.diameter), normals], axis=1), 3)
    _, first, back = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    normals, places = normals[first], places[first] + lift * normals[first]
    total = np.zeros(len(first))
    for _ in range(RAYS):
        d = rng.standard_normal(normals.shape)
        d = d / np.linalg.norm(d, axis=1, keepdims=True) + normals
        d /= np.maximum(np.linalg.norm(d, axis=1, keepdims=True), 1e-9)
        total += caster.cast(places, d).distances > 0.25 * surface.diameter
    return (0.25 + 0.75 * total / RAYS)[back.reshape(-1)].reshape(-1, 3)
