# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Draws one image: shadow map, background, surfaces; linear light out, and truth where asked."""

from typing import TYPE_CHECKING, cast

import numpy as np

from fairlead.render.images import LinearImage, TruthImage
from fairlead.render.ocean import Waves
from fairlead.render.raster import uniforms
from fairlead.render.raster.context import load_program, open_context
from fairlead.render.raster.matrices import check_pinhole
from fairlead.render.raster.model import Model, Shot
from fairlead.render.raster.textures import noise_texture, sky_texture, texture_of, wake_texture, wave_array
from fairlead.render.raster.vertices import Vertices
from fairlead.render.sky import harmonics
from fairlead.render.surroundings import Surroundings
from fairlead.types import Matrix4

if TYPE_CHECKING:
    import moderngl

SHADOW_PER_PIXEL = 2
"""Side of the shadow map in units of the image's, at most 2048."""
SAMPLES = 4
_CLIP_DISTANCE0 = 0x3000
_UNITS = {"sky_map": 0, "noise_map": 1, "shadow_map": 2, "wake_near": 3, "wake_far": 4}


class Renderer:
    """One context, images of at most one size. Raises RenderError where nothing can be drawn."""

    def __init__(self, width: int, height: int) -> None:
        self._context = context = open_context()
        self._size = (width, height)
        self._sea = load_program(context, "background.vert", "background.frag")
        self._paint = load_program(context, "surface.vert", "surface.frag")
        self._number = load_program(context, "surface.vert", "truth.frag")
        self._dark = load_program(context, "shadow.vert", "shadow.frag")
        corners = np.array([-1, -1, 1, -1, -1, 1, 1, 1], np.float32)
        self._screen = context.vertex_array(self._sea, [(context.buffer(corners.tobytes()), "2f", "corner")])
        colour = context.renderbuffer(self._size, 4, samples=SAMPLES, dtype="f2")
        self._many = context.framebuffer([colour], context.depth_renderbuffer(self._size, samples=SAMPLES))
        self._one = context.framebuffer([context.renderbuffer(self._size, 4, dtype="f2")])
        self._truth = context.framebuffer(
            [context.renderbuffer(self._size, 4, dtype="f4")], context.depth_renderbuffer(self._size)
        )
        side = min(2048, SHADOW_PER_PIXEL * max(width, height))
        self._shadow_map = context.depth_texture((side, side))
        self._shadow_map.compare_func = "<="
        self._shadow_map.repeat_x = self._shadow_map.repeat_y = False
        self._shadows = context.framebuffer([], self._shadow_map)
        self._noise = noise_texture(context)
        self._waves: list[moderngl.Texture] = []
        self._light: list[moderngl.Texture] = []
        self._surroundings: Surroundings | None = None
        self._shadow_state: tuple[object, ...] = ()

    def add(self, vertices: Vertices, thickness: np.ndarray | None = None) -> Model:
        """Put a packed surface on the graphics processor; `thickness` is that of each face, falling."""
        return Model(self._context, (self._paint, self._number, self._dark), vertices, thickness)

    def set_surroundings(self, surroundings: Surroundings) -> None:
        """Sky, wake and light of the images that follow."""
        for old in self._light:
            old.release()
        empty = np.zeros((2, 2, 3), np.float32)
        if surroundings.wake is None:
            wakes = [texture_of(self._context, empty, repeat=(False, False)) for _ in range(2)]
        else:
            wakes = [wake_texture(self._context, wake) for wake in surroundings.wake]
        behind = sky_texture(self._context, surroundings.sky, surroundings.backdrop)
        self._light = [behind, *wakes]
        self._surroundings = surroundings
        sky = surroundings.sky
        shared: dict[str, uniforms.Value] = {
            "sun": sky.sun_direction,
            "sun_irradiance": sky.sun_irradiance,
            "shade": harmonics(sky, surroundings.from_below),
            "air": surroundings.air_per_m,
            "place": ("sea", "space", "room").index(surroundings.kind),
        }
        _tell(self._paint, shared | {"weathering": surroundings.weathering} | _UNITS)
        earth = np.array([0.0, 0.0, -1.0, 1.1]) if surroundings.earth is None else surroundings.earth
        _tell(self._sea, shared | {"earth": earth, "water": np.array(surroundings.water), "gusts": 1.0} | _UNITS)

    def set_waves(self, waves: Waves) -> None:
        """The sea's surface of the images that follow."""
        arrays = [wave_array(waves, index) for index in range(len(waves.tiles))]
        if self._waves:
            for texture, array in zip(self._waves, arrays, strict=True):
                texture.write(array.tobytes())
                texture.build_mipmaps()
        else:
            self._waves = [texture_of(self._context, array, repeat=(True, True)) for array in arrays]
        _tell(self._sea, {"breaking": waves.breaking, "fine_variance": 0.0012 + 0.0006 * waves.wind_m_s})

    def draw(self, shot: Shot, target: Model, *, without_target: bool = False) -> LinearImage:
        """The image in linear light; `without_target` leaves it out, but not its shadow and mirror image.

        Raises RenderError for a camera with distortion, ValueError without light.
        """
        check_pinhole(shot.camera)
        surroundings = self._ready()
        light = self._cast_shadows(shot, target, surroundings)
        self._many.viewport = (0, 0, *self._fitting(shot))
        self._many.use()
        self._many.clear()
        for unit, texture in enumerate([self._light[0], self._noise, self._shadow_map, *self._light[1:], *self._waves]):
            texture.use(unit)
        self._context.disable(self._context.DEPTH_TEST)
        self._context.disable_direct(_CLIP_DISTANCE0)
        _tell(self._sea, uniforms.background_uniforms(shot, target, surroundings, light))
        self._sea["waves"] = [5, 6, 7, 8] if self._waves else [1, 1, 1, 1]
        self._screen.render(self._context.TRIANGLE_STRIP)
        self._enable_depth()
        span = uniforms.depth_range(shot, target)
        _tell(self._paint, {"shadow_of_eye": light.T} | uniforms.haze(shot, surroundings))
        for model, T_world_model in _placed(shot, target)[int(without_target) :]:
            told = uniforms.surface_uniforms(shot, model, T_world_model, surroundings, span)
            _tell(self._paint, told | {"shadowed": int(model is target)})
            model.painted.render(vertices=model.count(shot.camera.K[0, 0] / max(span[0], 1e-3)))
        self._context.copy_framebuffer(self._one, self._many)
        pixels = self._read(self._one, np.float16, shot)
        return LinearImage(radiance=pixels[..., :3].copy(), distance=pixels[..., 3].copy())

    def truth(self, shot: Shot, target: Model) -> TruthImage:
        """Mask of the target and depth, one sample at the centre of each pixel."""
        check_pinhole(shot.camera)
        surroundings = self._ready()
        self._truth.viewport = (0, 0, *self._fitting(shot))
        self._truth.use()
        self._truth.clear()
        self._enable_depth()
        span = uniforms.depth_range(shot, target)
        for number, (model, T_world_model) in enumerate(_placed(shot, target), 1):
            told = uniforms.surface_uniforms(shot, model, T_world_model, surroundings, span)
            _tell(self._number, told | {"number": float(number)})
            model.numbered.render()
        pixels = self._read(self._truth, np.float32, shot)
        depth = np.where(pixels[..., 1] > 0.0, pixels[..., 0], np.float32(np.inf))
        return TruthImage(mask=pixels[..., 1] == 1.0, depth=depth)

    def _ready(self) -> Surroundings:
        if self._surroundings is None or (self._surroundings.kind == "sea" and not self._waves):
            raise ValueError("renderer: expected set_surroundings, and at sea set_waves, before an image")
        return self._surroundings

    def _enable_depth(self) -> None:
        self._context.enable(self._context.DEPTH_TEST)
        self._context.enable_direct(_CLIP_DISTANCE0)

    def _cast_shadows(self, shot: Shot, target: Model, surroundings: Surroundings) -> Matrix4:
        """Draws the shadow map; returns eye axes -> its coordinates."""
        light = uniforms.clip_of_eye_light(shot, target, surroundings.sky.sun_direction)
        light_of_target = light @ uniforms.eye_of_world(shot) @ shot.T_world_target
        state = (id(target), target.version, light_of_target.round(5).tobytes())
        if state == self._shadow_state:
            return uniforms.shadow_of_eye(light)
        self._shadow_state = state
        self._shadows.use()
        self._shadows.clear()
        self._context.enable(self._context.DEPTH_TEST)
        self._context.disable_direct(_CLIP_DISTANCE0)
        _tell(self._dark, {"light_of_target": light_of_target.T})
        target.dark.render()
        return uniforms.shadow_of_eye(light)

    def _fitting(self, shot: Shot) -> tuple[int, int]:
        """Size of the shot's image, which may be smaller than the renderer's. Raises ValueError if it is larger."""
        size = (shot.camera.width, shot.camera.height)
        if size[0] > self._size[0] or size[1] > self._size[1]:
            raise ValueError(f"renderer: expected an image of at most {self._size}, got {size}")
        return size

    def _read(
        self, framebuffer: "moderngl.Framebuffer", dtype: type[np.float16] | type[np.float32], shot: Shot
    ) -> np.ndarray:
        width, height = self._fitting(shot)
        raw = framebuffer.read((0, 0, width, height), components=4, dtype="f2" if dtype is np.float16 else "f4")
        return np.frombuffer(raw, dtype).reshape(height, width, 4).astype(np.float32)


def _placed(shot: Shot, target: Model) -> list[tuple[Model, Matrix4]]:
    return [(target, shot.T_world_target), *shot.others]


def _tell(program: "moderngl.Program", values: dict[str, uniforms.Value] | dict[str, int]) -> None:
    """Set uniforms; those that the compiler found useless are left out."""
    for name, value in values.items():
        member = cast("moderngl.Uniform | None", program.get(name, None))
        if member is None:
            continue
        if isinstance(value, np.ndarray):
            used = value[: member.array_length] if member.array_length > 1 else value  # compilers trim arrays
            member.write(np.ascontiguousarray(used, dtype=np.float32).tobytes())
        else:
            member.value = value
