# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Path tracing of a target and the sea about it. docs/rendering.md section 9."""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from fairlead.render.cycles.blender import (
    add_camera,
    camera_matrix,
    empty_scene,
    load_blender,
    mesh_of,
    place,
    set_camera,
    silenced,
)
from fairlead.render.cycles.materials import light, painted, water
from fairlead.render.cycles.sea import SeaPatch, foam_tile, image_box, make_patch
from fairlead.render.errors import RenderError
from fairlead.render.images import Distance, LinearImage, TruthImage
from fairlead.render.ocean import Waves
from fairlead.render.raster.model import Model, Shot
from fairlead.render.raster.renderer import Renderer
from fairlead.render.raster.uniforms import haze
from fairlead.render.raster.vertices import corner_normals
from fairlead.render.surface import Surface
from fairlead.render.surroundings import Surroundings, waterline
from fairlead.types import Camera

TARGET_INDEX = 1


class Tracer:
    """Sea and sky of the fast renderer; over them a target, its shadow and mirror image by path tracing.

    `renderer` has the same surroundings set, and before each image the same waves; `model` is `surface` on it.
    One tracer at a time: Blender has one scene. Raises RenderError where there is no Blender.
    """

    def __init__(
        self,
        renderer: Renderer,
        model: Model,
        surface: Surface,
        surroundings: Surroundings,
        samples: int,
        threads: int | None = None,
    ) -> None:
        self._bpy, self._openexr = load_blender()
        bpy = self._bpy
        self._renderer, self._model, self._surroundings = renderer, model, surroundings
        self._hull, self._top = waterline(surface), float(surface.corners[1][2])
        self._foam = foam_tile()
        self._scene = empty_scene(bpy, samples, threads)
        self._camera = add_camera(bpy, self._scene)
        light(bpy, self._scene, surroundings)
        self._target = _target_object(bpy, self._scene, surface, surroundings.weathering)
        self._water = water(bpy, surroundings)
        self._sea: Any = None

    def render(self, shot: Shot, waves: Waves | None, seed: int) -> tuple[LinearImage, TruthImage]:
        """Light and truth; the same seed gives the same light."""
        truth = self._renderer.truth(shot, self._model)
        box = image_box(shot, self._hull, self._top)
        if box is None:
            return self._renderer.draw(shot, self._model), truth
        behind = self._renderer.draw(shot, self._model, without_target=True)
        if waves is not None:
            self._set_sea(make_patch(shot, box, waves, self._surroundings, self._hull, self._foam))
        set_camera(self._scene, self._camera, shot.camera)
        place(self._target, shot.T_world_target)
        place(self._camera, camera_matrix(shot.T_camera_world))
        colour, index = self._trace(shot.camera, box, seed)
        return self._composed(shot, box, colour, index, behind, truth)

    def _set_sea(self, patch: SeaPatch | None) -> None:
        """Exchange the mesh of the near sea."""
        if self._sea is not None:
            mesh = self._sea.data
            self._bpy.data.objects.remove(self._sea)
            self._bpy.data.meshes.remove(mesh)
            self._sea = None
        if patch is None:
            return
        rows, columns = patch.foam.shape
        number = np.arange(rows * columns).reshape(rows, columns)
        quads = np.stack([number[1:, :-1], number[1:, 1:], number[:-1, 1:], number[:-1, :-1]], axis=-1).reshape(-1, 4)
        mesh = mesh_of(self._bpy, "sea", patch.vertices.reshape(-1, 3), quads)
        mesh.polygons.foreach_set("use_smooth", np.ones(len(quads), bool))
        for name, values in (("foam", patch.foam), ("rough", patch.rough), ("near", patch.near)):
            mesh.attributes.new(name, "FLOAT", "POINT").data.foreach_set("value", values.astype(np.float32).ravel())
        mesh.materials.append(self._water)
        self._sea = self._bpy.data.objects.new("sea", mesh)
        self._sea.pass_index = TARGET_INDEX + 1
        self._scene.collection.objects.link(self._sea)

    def _trace(self, camera: Camera, box: tuple[int, int, int, int], seed: int) -> tuple[np.ndarray, np.ndarray]:
        """Colour with alpha, and object numbers, of a box of the image."""
        render, (x0, y0, x1, y1) = self._scene.render, box
        W, H = camera.width, camera.height
        render.use_border = render.use_crop_to_border = True
        render.border_min_x, render.border_max_x = (x0 + 1e-3) / W, (x1 + 1e-3) / W
        render.border_min_y, render.border_max_y = (H - y1 + 1e-3) / H, (H - y0 + 1e-3) / H
        self._scene.cycles.seed = seed % (2**31)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "box.exr"
            render.filepath = str(path)
            with silenced():
                self._bpy.ops.render.render(write_still=True)
            channels = _read_exr(self._openexr, path)
        colour, index = channels["Combined"], channels["IndexOB"]
        if colour.shape[:2] != (y1 - y0, x1 - x0):
            raise RenderError(f"Cycles gave {colour.shape[1]} x {colour.shape[0]} px for {x1 - x0} x {y1 - y0}")
        return colour, index

    def _composed(
        self,
        shot: Shot,
        box: tuple[int, int, int, int],
        colour: np.ndarray,
        index: np.ndarray,
        behind: LinearImage,
        truth: TruthImage,
    ) -> tuple[LinearImage, TruthImage]:
        """Traced light through the air, over the sea of the fast renderer."""
        x0, y0, x1, y1 = box
        part = np.s_[y0:y1, x0:x1]
        alpha = np.clip(colour[..., 3:], 0.0, 1.0)
        surface = np.isfinite(truth.depth)
        distance = np.where(surface, truth.depth * ray_lengths(shot.camera), behind.distance)
        through = np.exp(-self._surroundings.air_per_m * distance[part])[..., None]
        edges = haze(shot, self._surroundings)
        across = ((np.arange(x0, x1) + 0.5) / shot.camera.width)[None, :, None]
        air = np.asarray(edges["haze_left"]) * (1.0 - across) + np.asarray(edges["haze_right"]) * across
        radiance = behind.radiance.copy()
        light_in = colour[..., :3] * through + alpha * (1.0 - through) * air
        radiance[part] = np.maximum(light_in + (1.0 - alpha) * behind.radiance[part], 0.0)
        mask = np.zeros_like(truth.mask)
        mask[part] = np.round(index) == TARGET_INDEX
        depth = np.where(mask, truth.depth, np.float32(np.inf))
        return LinearImage(radiance=radiance, distance=distance), TruthImage(mask=mask, depth=depth)


def ray_lengths(camera: Camera) -> Distance:
    """Distance of a surface over its z, at every pixel of a pinhole camera."""
    x = (np.arange(camera.width) - camera.K[0, 2]) / camera.K[0, 0]
    y = (np.arange(camera.height) - camera.K[1, 2]) / camera.K[1, 1]
    return np.sqrt(1.0 + x[None, :] ** 2 + y[:, None] ** 2).astype(np.float32)


def _target_object(bpy: Any, scene: Any, surface: Surface, weathering: float) -> Any:
    mesh = mesh_of(bpy, "target", surface.vertices, surface.faces)
    for material in surface.materials:
        mesh.materials.append(painted(bpy, material, weathering))
    mesh.polygons.foreach_set("material_index", surface.material_of_face.astype(np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(len(surface.faces), bool))
    mesh.normals_split_custom_set(corner_normals(surface).reshape(-1, 3).tolist())
    mesh.update()
    made = bpy.data.objects.new("target", mesh)
    made.pass_index = TARGET_INDEX
    scene.collection.objects.link(made)
    return made


def _read_exr(openexr: Any, path: Path) -> dict[str, np.ndarray]:
    """Passes of a multilayer EXR by their last names."""
    found: dict[str, np.ndarray] = {}
    with openexr.File(str(path)) as stream:
        for name, channel in stream.channels().items():
            key = name.split(".")[1] if name.count(".") >= 1 else name
            found[key] = np.asarray(channel.pixels, dtype=np.float32)
    return found
