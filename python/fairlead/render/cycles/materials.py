# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Painted metal, water, and the light of the sky, as Cycles wants them."""

from typing import Any

import numpy as np

from fairlead.render.cycles.blender import Nodes
from fairlead.render.sky import Sky
from fairlead.render.surface import Material
from fairlead.render.surroundings import Surroundings

ENVIRONMENT_ROWS = 1024


def painted(bpy: Any, material: Material, weathering: float) -> Any:
    """Principled paint with patches, and streaks of rust on what is steep."""
    made = bpy.data.materials.new(material.name)
    made.use_nodes = True
    n = Nodes(made.node_tree)
    place = n.add("ShaderNodeTexCoord").outputs["Object"]
    stretched = n.add("ShaderNodeMapping", {0: place, "Scale": (1.0, 1.0, 0.12)}).outputs[0]
    patches = n.add("ShaderNodeTexNoise", {"Vector": stretched, "Scale": 0.7, "Detail": 6.0}).outputs[0]
    gain = n.add(
        "ShaderNodeMapRange", {0: patches, 1: 0.3, 2: 0.7, 3: 1.0 - 0.45 * weathering, 4: 1.0 + 0.2 * weathering}
    )
    grey = n.add("ShaderNodeCombineXYZ", {0: gain.outputs[0], 1: gain.outputs[0], 2: gain.outputs[0]}).outputs[0]
    colour = n.add(
        "ShaderNodeMix", {0: 1.0, 6: (*material.colour, 1.0), 7: grey}, data_type="RGBA", blend_type="MULTIPLY"
    )
    streaks = n.add("ShaderNodeMapping", {0: place, "Scale": (1.4, 1.4, 0.09)}).outputs[0]
    rust = n.add("ShaderNodeTexNoise", {"Vector": streaks, "Scale": 0.8, "Detail": 5.0}).outputs[0]
    amount = n.add("ShaderNodeMapRange", {0: rust, 1: 0.64, 2: 0.80, 3: 0.0, 4: 0.6 * weathering}).outputs[0]
    brown = (0.16, 0.085, 0.045, 1.0)
    stained = n.add("ShaderNodeMix", {0: amount, 6: colour.outputs[2], 7: brown}, data_type="RGBA").outputs[2]
    shader = n.add("ShaderNodeBsdfPrincipled", {"Base Color": stained, "Roughness": material.roughness})
    n.add("ShaderNodeOutputMaterial", {0: shader.outputs[0]})
    return made


def water(bpy: Any, surroundings: Surroundings) -> Any:
    """Water with foam; attributes of the mesh say how rough and how foamy it is and how far it is to be seen at all."""
    made = bpy.data.materials.new("water")
    made.use_nodes = True
    n = Nodes(made.node_tree)
    foam, rough, near = (
        n.add("ShaderNodeAttribute", attribute_name=name).outputs["Fac"] for name in ("foam", "rough", "near")
    )
    deep = (*(np.pi * np.array(surroundings.water)).tolist(), 1.0)
    colour = n.add("ShaderNodeMix", {0: foam, 6: deep, 7: (0.56, 0.60, 0.62, 1.0)}, data_type="RGBA").outputs[2]
    roughness = n.add("ShaderNodeMix", {0: foam, 2: rough, 3: 0.85}, data_type="FLOAT").outputs[0]
    wet = n.add("ShaderNodeBsdfPrincipled", {"Base Color": colour, "Roughness": roughness, "IOR": 1.333})
    clear = n.add("ShaderNodeBsdfTransparent")
    mixed = n.add("ShaderNodeMixShader", {0: near, 1: clear.outputs[0], 2: wet.outputs[0]})
    n.add("ShaderNodeOutputMaterial", {0: mixed.outputs[0]})
    return made


def environment_pixels(sky: Sky, below: np.ndarray, rows: int = ENVIRONMENT_ROWS) -> np.ndarray:
    """Cycles' equirectangular image of the sky, (rows, 2 rows, 4): row 0 straight down, azimuth falling along a row."""
    latitude = np.pi * ((np.arange(rows) + 0.5) / rows - 0.5)
    azimuth = 2.0 * np.pi * (0.5 - (np.arange(2 * rows) + 0.5) / (2 * rows))
    source_rows, source_columns = sky.radiance.shape[:2]
    row = np.sqrt(np.clip(latitude, 0.0, None) / (0.5 * np.pi)) * source_rows - 0.5
    row = np.clip(np.round(row), 0, source_rows - 1).astype(int)
    column = np.floor(azimuth / (2.0 * np.pi) * source_columns).astype(int) % source_columns
    image = np.ones((rows, 2 * rows, 4), np.float32)
    image[..., :3] = sky.radiance[row][:, column]
    image[latitude < 0.0, :, :3] = below
    return image


def light(bpy: Any, scene: Any, surroundings: Surroundings) -> None:
    """Sky as a picture all round, sun as a lamp."""
    pixels = environment_pixels(surroundings.sky, surroundings.from_below)
    picture = bpy.data.images.new("sky", pixels.shape[1], pixels.shape[0], float_buffer=True)
    picture.colorspace_settings.name = "Non-Color"
    picture.pixels.foreach_set(pixels.ravel())
    picture.update()
    world = bpy.data.worlds.new("sky")
    scene.world = world
    world.use_nodes = True
    n = Nodes(world.node_tree)
    texture = n.add("ShaderNodeTexEnvironment", image=picture)
    n.add("ShaderNodeOutputWorld", {0: n.add("ShaderNodeBackground", {0: texture.outputs[0]}).outputs[0]})
    world.cycles.sampling_method = "MANUAL"
    world.cycles.sample_map_resolution = 512
    irradiance = surroundings.sky.sun_irradiance
    strength = float(irradiance.max())
    if strength <= 0.0:
        return
    lamp = bpy.data.lights.new("sun", "SUN")
    lamp.energy = strength
    lamp.color = (irradiance / strength).tolist()
    lamp.angle = float(np.radians(0.53 + 4.0 * surroundings.sky.overcast))
    made = bpy.data.objects.new("sun", lamp)
    scene.collection.objects.link(made)
    sun = surroundings.sky.sun_direction
    side = np.cross([0.0, 0.0, 1.0], sun) if abs(sun[2]) < 0.999 else np.array([1.0, 0.0, 0.0])
    side /= np.linalg.norm(side)
    T = np.eye(4)
    T[:3, :3] = np.column_stack([side, np.cross(sun, side), sun])
    made.matrix_world = [row.tolist() for row in T.T]
