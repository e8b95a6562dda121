# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Mesh files <-> Surface. PLY is written with face colours; whatever trimesh reads is read.

Colours in files are sRGB of 8 bits. Each colour is one material; a header comment `material NAME R G B ROUGHNESS` of a
PLY file gives it a name and a roughness.
"""

from pathlib import Path

import numpy as np
from jaxtyping import UInt8

from fairlead.io.errors import InputError
from fairlead.render.surface import Material, Surface

MAX_FACES = 2_000_000
"""A larger mesh is refused."""
GREY = (0.4, 0.4, 0.4)
"""Reflectance of a mesh without colours [-]."""

ColourCodes = UInt8[np.ndarray, "m 3"]

_FACE = np.dtype([("count", "u1"), ("vertex", "<i4", 3), ("colour", "u1", 3)])


def to_srgb(linear: np.ndarray) -> np.ndarray:
    """Linear light 0..1 -> sRGB 0..1 (IEC 61966-2-1)."""
    clipped = np.clip(linear, 0.0, 1.0)
    return np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * np.maximum(clipped, 1e-9) ** (1 / 2.4) - 0.055)


def to_linear(srgb: np.ndarray) -> np.ndarray:
    """sRGB 0..1 -> linear light 0..1."""
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def save_surface(path: Path, surface: Surface) -> None:
    """Write a binary PLY. Materials whose 8-bit colours are equal come back as one."""
    codes = np.round(255.0 * to_srgb(np.array([material.colour for material in surface.materials]))).astype(np.uint8)
    comments = [
        f"comment material {material.name} {code[0]} {code[1]} {code[2]} {material.roughness:g}"
        for material, code in zip(surface.materials, codes, strict=True)
    ]
    header = [
        *("ply", "format binary_little_endian 1.0", *comments),
        *(f"element vertex {len(surface.vertices)}", *(f"property float {axis}" for axis in "xyz")),
        *(f"element face {len(surface.faces)}", "property list uchar int vertex_indices"),
        *(*(f"property uchar {part}" for part in ("red", "green", "blue")), "end_header", ""),
    ]
    faces = np.zeros(len(surface.faces), _FACE)
    faces["count"] = 3
    faces["vertex"] = surface.faces
    faces["colour"] = codes[surface.material_of_face]
    path.write_bytes("\n".join(header).encode() + surface.vertices.astype("<f4").tobytes() + faces.tobytes())


def load_surface(path: Path) -> Surface:
    """Read a mesh in metres, colours by face, vertex or material. Raises InputError: no readable triangles."""
    import trimesh

    try:
        mesh = trimesh.load(path, force="mesh", process=False)
        vertices = np.array(mesh.vertices, dtype=np.float64)  # pyright: ignore[reportAttributeAccessIssue]
        faces = np.array(mesh.faces, dtype=np.int64)  # pyright: ignore[reportAttributeAccessIssue]
        codes = _colour_codes(mesh, len(faces))
    except Exception as error:  # any loader of trimesh may raise what it likes on a broken file
        first_line = (str(error).splitlines() or [type(error).__name__])[0]
        raise InputError(path, f"no readable mesh: {first_line}") from error
    if not 0 < len(faces) <= MAX_FACES:
        raise InputError(path, f"expected a mesh of 1 to {MAX_FACES} triangles, got {len(faces)}")
    materials, material_of_face = _materials(codes, _named(path))
    try:
        return Surface(vertices=vertices, faces=faces, materials=materials, material_of_face=material_of_face)
    except ValueError as error:
        raise InputError(path, str(error)) from error


def _colour_codes(mesh: object, count: int) -> ColourCodes:
    """sRGB of each face, 8 bits; grey where the file has no colours."""
    visual = getattr(mesh, "visual", None)
    if visual is not None and getattr(visual, "kind", None) == "texture":
        visual = visual.to_color()
    if visual is None or getattr(visual, "kind", None) is None:
        return np.tile(np.round(255.0 * to_srgb(np.array(GREY))).astype(np.uint8), (count, 1))
    return np.array(visual.face_colors, dtype=np.uint8)[:, :3]


def _named(path: Path) -> dict[tuple[int, int, int], tuple[str, float]]:
    """Name and roughness by colour from the comments of a PLY header."""
    named: dict[tuple[int, int, int], tuple[str, float]] = {}
    if path.suffix.lower() != ".ply":
        return named
    with path.open("rb") as stream:
        head = stream.read(65536).split(b"end_header")[0].decode("ascii", errors="replace")
    for line in head.splitlines():
        words = line.split()
        if words[:2] == ["comment", "material"] and len(words) == 7:
            try:
                code = (int(words[3]), int(words[4]), int(words[5]))
                named[code] = (words[2], min(1.0, max(0.0, float(words[6]))))
            except ValueError as error:
                raise InputError(path, f"expected 'material NAME R G B ROUGHNESS', got {line[:80]!r}") from error
    return named


def _materials(
    codes: ColourCodes, named: dict[tuple[int, int, int], tuple[str, float]]
) -> tuple[tuple[Material, ...], np.ndarray]:
    """One material per colour."""
    unique, index = np.unique(codes, axis=0, return_inverse=True)
    materials: list[Material] = []
    for k, (red, green, blue) in enumerate(unique.tolist()):
        name, roughness = named.get((red, green, blue), (f"colour{k}", 0.55))
        r, g, b = to_linear(np.array([red, green, blue]) / 255.0).tolist()
        materials.append(Material(name=name, colour=(r, g, b), roughness=roughness))
    return tuple(materials), index.reshape(-1).astype(np.int64)
