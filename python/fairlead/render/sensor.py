# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Linear light -> what a camera stores: exposure, blur, noise, tone curve, 8 bits. docs/rendering.md section 6."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import UInt8

from fairlead.opencv.filters import blurred
from fairlead.render.images import Radiance
from fairlead.render.surface_file import to_srgb

Picture = UInt8[np.ndarray, "h w 3"]
"""Red, green, blue."""

KEY = 0.85
"""Exposed radiance of a white wall that gets all the light of the level ground [-]."""


@dataclass(frozen=True, kw_only=True)
class Sensor:
    """A camera's sensor and lens."""

    exposure: float
    """Radiance is multiplied by this; 1 then is nearly white."""
    blur_px: float = 0.45
    """Point spread of lens and pixel, one standard deviation."""
    full_well: float = 9000.0
    """Electrons at exposed radiance 1."""
    read_noise: float = 6.0
    """Electrons, one standard deviation."""
    vignetting: float = 0.12
    """What the corners lose [-]."""
    bloom: float = 0.02
    """Share of the light beyond white that is scattered in the lens."""


def exposure_for(level_irradiance: float) -> float:
    """The exposure that an averaging light meter would choose."""
    return KEY * np.pi / max(level_irradiance, 1e-6)


def tone_curve(exposed: np.ndarray) -> np.ndarray:
    """Linear below, a shoulder above: x (1 + x / 16) / (1 + x / 1.45), in sRGB, docs/rendering.md eq. (5)."""
    return to_srgb(exposed * (1.0 + exposed / 16.0) / (1.0 + exposed / 1.45) * 1.15)


def develop(radiance: Radiance, sensor: Sensor, rng: np.random.Generator) -> Picture:
    """The stored picture. `rng` is the noise: the same state, the same picture."""
    light = radiance * np.float32(sensor.exposure)
    if sensor.bloom > 0.0:
        beyond = np.minimum(np.maximum(light - 1.0, 0.0), 30.0)
        if float(beyond.max(initial=0.0)) > 0.0:
            size = 0.01 * max(light.shape[:2])
            spread = blurred(beyond, size) + blurred(beyond, 4.0 * size)
            light = light + np.float32(sensor.bloom * 2.0) * spread
    light = blurred(np.ascontiguousarray(light, np.float32), sensor.blur_px)
    if sensor.vignetting > 0.0:
        light = light * _vignette(light.shape[0], light.shape[1], sensor.vignetting)[..., None]
    spread = np.sqrt(np.maximum(light, 0.0) / sensor.full_well + (sensor.read_noise / sensor.full_well) ** 2)
    light = np.maximum(light + spread * rng.standard_normal(light.shape, np.float32), 0.0)
    return _CURVE[np.minimum(light * _STEPS, len(_CURVE) - 1).astype(np.int32)]


def _vignette(height: int, width: int, strength: float) -> np.ndarray:
    y, x = np.linspace(-1.0, 1.0, height), np.linspace(-1.0, 1.0, width)
    return (1.0 - 0.5 * strength * (y[:, None] ** 2 + x[None, :] ** 2)).astype(np.float32)


_STEPS = 2048.0
_CURVE = np.round(255.0 * tone_curve(np.arange(round(24 * _STEPS)) / _STEPS)).clip(0, 255).astype(np.uint8)
