# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The one place that imports bpy, and OpenEXR for what it writes, and what every scene of it needs."""

import importlib
import os
import sys
from collections.abc import Generator
from contextlib import contextmanager
from typing import Any

import numpy as np

from fairlead.render.errors import RenderError
from fairlead.types import Camera, Matrix4


def load_blender() -> tuple[Any, Any]:
    """Blender as a module, and the reader of its images. Raises RenderError where one of them is not installed."""
    try:
        return importlib.import_module("bpy"), importlib.import_module("OpenEXR")
    except ImportError as error:
        raise RenderError(
            "full quality needs bpy and OpenEXR (Python 3.11: pip install 'fairlead[render]'), "
            f"or take --quality draft: {error}"
        ) from error


def empty_scene(bpy: Any, samples: int, threads: int | None) -> Any:
    """A scene for the processor, few bounces, denoised, transparent where nothing is."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = samples
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = True
    scene.cycles.denoiser = "OPENIMAGEDENOISE"
    scene.cycles.denoising_prefilter = "FAST"
    scene.cycles.max_bounces = 3
    scene.cycles.diffuse_bounces = scene.cycles.glossy_bounces = 2
    scene.cycles.transmission_bounces = 0
    scene.cycles.transparent_max_bounces = 8
    scene.cycles.caustics_reflective = scene.cycles.caustics_refractive = False
    scene.cycles.sample_clamp_direct = 20.0
    scene.cycles.sample_clamp_indirect = 4.0
    scene.cycles.filter_width = 1.2
    scene.render.film_transparent = True
    if threads is not None:
        scene.render.threads_mode, scene.render.threads = "FIXED", threads
    scene.render.use_persistent_data = True
    layer = bpy.context.view_layer
    layer.use_pass_object_index = True
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR_MULTILAYER", "32", "ZIP"
    return scene


def add_camera(bpy: Any, scene: Any) -> Any:
    """The scene's camera, not yet pointed at anything."""
    made = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(made)
    scene.camera = made
    return made


def set_camera(scene: Any, made: Any, camera: Camera) -> None:
    """A pinhole camera; Blender's image, too, is the plane -1/2 to W - 1/2. Raises RenderError for oblong pixels."""
    fx, fy = float(camera.K[0, 0]), float(camera.K[1, 1])
    if abs(fx - fy) > 1e-6 * fx:
        raise RenderError(f"camera {camera.name}: full quality expects square pixels, got focal lengths {fx} and {fy}")
    W, H = camera.width, camera.height
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = W, H, 100
    data = made.data
    data.sensor_fit = "HORIZONTAL"
    data.sensor_width = 36.0
    data.lens = fx * 36.0 / W
    data.shift_x = -(float(camera.K[0, 2]) + 0.5 - 0.5 * W) / W
    data.shift_y = (float(camera.K[1, 2]) + 0.5 - 0.5 * H) / W
    data.clip_start, data.clip_end = 0.5, 1e5


@contextmanager
def silenced() -> Generator[None]:
    """Blender writes its progress to the process's standard output, past Python: to nowhere with it."""
    sys.stdout.flush()
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def place(thing: Any, T_world_thing: Matrix4) -> None:
    """Put an object where a motion says."""
    thing.matrix_world = [row.tolist() for row in T_world_thing.T]


def camera_matrix(T_camera_world: Matrix4) -> Matrix4:
    """T_world_camera in Blender's axes: x right, y up, z backwards."""
    T = np.eye(4)
    T[:3, :3] = T_camera_world[:3, :3].T @ np.diag([1.0, -1.0, -1.0])
    T[:3, 3] = -T_camera_world[:3, :3].T @ T_camera_world[:3, 3]
    return T


def mesh_of(bpy: Any, name: str, vertices: np.ndarray, polygons: np.ndarray) -> Any:
    """A mesh of polygons that all have the same number of corners."""
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(vertices, np.float32).ravel())
    mesh.loops.add(polygons.size)
    mesh.loops.foreach_set("vertex_index", np.ascontiguousarray(polygons, np.int32).ravel())
    mesh.polygons.add(len(polygons))
    mesh.polygons.foreach_set("loop_start", np.arange(0, polygons.size, polygons.shape[1], dtype=np.int32))
    mesh.update(calc_edges=True)
    return mesh


class Nodes:
    """A node tree being written: `add` makes a node, sets its inputs by name or number, and returns it."""

    def __init__(self, tree: Any) -> None:
        self._tree = tree
        tree.nodes.clear()

    def add(self, kind: str, inputs: dict[str | int, Any] | None = None, **fields: Any) -> Any:
        """A value is set, a socket is linked."""
        node = self._tree.nodes.new(kind)
        for name, value in fields.items():
            setattr(node, name, value)
        for key, value in (inputs or {}).items():
            if hasattr(value, "is_linked"):
                self._tree.links.new(value, node.inputs[key])
            else:
                node.inputs[key].default_value = value
        return node
