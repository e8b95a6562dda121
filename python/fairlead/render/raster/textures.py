# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Arrays -> textures."""

from typing import TYPE_CHECKING

import numpy as np

from fairlead.render.noise import fractal_tile
from fairlead.render.ocean import Waves
from fairlead.render.sky import Backdrop, Sky
from fairlead.render.wake import WakeMap

if TYPE_CHECKING:
    import moderngl


def texture_of(context: "moderngl.Context", array: np.ndarray, *, repeat: tuple[bool, bool]) -> "moderngl.Texture":
    """Half-precision texture with mipmaps; row 0 is at 0."""
    rows, columns = array.shape[:2]
    texture = context.texture((columns, rows), array.shape[2], array.astype(np.float16).tobytes(), dtype="f2")
    texture.build_mipmaps()
    texture.filter = (context.LINEAR_MIPMAP_LINEAR, context.LINEAR)
    texture.repeat_x, texture.repeat_y = repeat
    return texture


def sky_texture(context: "moderngl.Context", sky: Sky, backdrop: Backdrop | None) -> "moderngl.Texture":
    """Azimuth repeats, elevation does not. Where there is a backdrop, it takes the place of the sky."""
    radiance = sky.radiance if backdrop is None else backdrop
    return texture_of(context, np.minimum(radiance, 100.0), repeat=(True, False))


def noise_texture(context: "moderngl.Context") -> "moderngl.Texture":
    """The one fractal tile of all programs."""
    return texture_of(context, fractal_tile(512, 1.8, np.random.default_rng(7))[..., None], repeat=(True, True))


def wake_texture(context: "moderngl.Context", wake: WakeMap) -> "moderngl.Texture":
    """Clamped: zero at its edges."""
    return texture_of(context, wake.image, repeat=(False, False))


def wave_array(waves: Waves, index: int) -> np.ndarray:
    """Slopes, half the sum of their squares (its mean over a footprint is variance), squeeze."""
    tile = waves.tiles[index]
    half = 0.5 * (tile.slope**2).sum(axis=2, keepdims=True)
    return np.concatenate([tile.slope, half, tile.squeeze[..., None]], axis=2).astype(np.float16)
