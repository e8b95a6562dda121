# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Weather laid over a finished linear image: the labels stay, and one render serves every weather.

All of it depends on time and seed only, never on the number of the frame, so that sequences stay coherent.
docs/rendering.md section 6. Source: Koschmieder 1924 (visibility).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from fairlead.opencv.filters import blurred
from fairlead.render.images import FAR_M, LinearImage, Radiance
from fairlead.render.precipitation import Flakes, falling
from fairlead.render.sensor import Sensor
from fairlead.types import Camera, Matrix4, Vector3

Kind = Literal["fog", "rain", "snow", "glare", "dusk", "night", "low-contrast"]
KINDS: tuple[Kind, ...] = get_args(Kind)


@dataclass(frozen=True, kw_only=True)
class Weather:
    """What is between target and sensor. Raises ValueError for another kind or strength."""

    kind: Kind
    strength: float = 0.5
    """0 is clear, 1 as bad as it gets."""
    seed: int = 0

    def __post_init__(self) -> None:
        if self.kind not in KINDS or not 0.0 <= self.strength <= 1.0:
            raise ValueError(f"weather: expected one of {', '.join(KINDS)} and a strength of 0 to 1, got {self}")


@dataclass(frozen=True, kw_only=True, eq=False)
class Circumstances:
    """What weather needs to know of a frame."""

    camera: Camera
    T_camera_world: Matrix4
    time_s: float
    air: Vector3
    """Radiance of the horizon."""
    sun_world: Vector3
    """Unit, towards the sun."""
    wind_m_s: float = 8.0


def apply_weather(
    image: LinearImage, sensor: Sensor, weather: Weather, frame: Circumstances
) -> tuple[LinearImage, Sensor]:
    """The light that reaches the sensor, and how the sensor is set for it."""
    return _APPLY[weather.kind](image, sensor, weather, frame)


def visibility_m(strength: float, best_m: float, worst_m: float) -> float:
    """Visibility, docs/rendering.md eq. (6): in equal ratios."""
    return best_m * (worst_m / best_m) ** strength


def _veiled(image: LinearImage, visibility: float, air: Vector3) -> LinearImage:
    """L exp(-b d) + A (1 - exp(-b d)), b = 3.912 / visibility: docs/rendering.md eq. (7)."""
    through = np.exp(-np.float32(3.912 / visibility) * image.distance)[..., None]
    return replace(image, radiance=(image.radiance * through + air.astype(np.float32) * (1.0 - through)))


def _breathing(weather: Weather, time_s: float) -> float:
    """Fog is never quite even: a slow swing by a tenth."""
    return 1.0 + 0.1 * float(np.sin(0.21 * time_s + weather.seed) * np.sin(0.083 * time_s + 1.7 * weather.seed))


def _fog(image: LinearImage, sensor: Sensor, weather: Weather, frame: Circumstances) -> tuple[LinearImage, Sensor]:
    visibility = visibility_m(weather.strength, 30_000.0, 400.0) * _breathing(weather, frame.time_s)
    grey = 0.6 * frame.air.mean() + 0.4 * frame.air
    dimmed = replace(image, radiance=_flattened(image.radiance, 0.35 * weather.strength))
    return _veiled(dimmed, visibility, 0.9 * grey), sensor


def _rain(image: LinearImage, sensor: Sensor, weather: Weather, frame: Circumstances) -> tuple[LinearImage, Sensor]:
    s = weather.strength
    grey = 0.8 * frame.air.mean() + 0.2 * frame.air
    flat = replace(image, radiance=_flattened(image.radiance, 0.5 * s) * np.float32(1.0 - 0.35 * s))
    veiled = _veiled(flat, visibility_m(s, 15_000.0, 1_200.0) * _breathing(weather, frame.time_s), 0.6 * grey)
    drops = Flakes(count=round(150_000 * s), size_m=0.0022, fall_m_s=7.5, drift_m_s=0.6 * frame.wind_m_s, sway_m=0.0)
    layer = falling(drops, frame.camera, frame.T_camera_world, frame.time_s, 1.0 / 120.0, weather.seed)[..., None]
    light = veiled.radiance * (1.0 - 0.25 * layer) + 0.55 * layer * np.float32(0.6 * grey.mean() * 1.6)
    return replace(veiled, radiance=light.astype(np.float32)), replace(sensor, blur_px=sensor.blur_px + 0.35 * s)


def _snow(image: LinearImage, sensor: Sensor, weather: Weather, frame: Circumstances) -> tuple[LinearImage, Sensor]:
    s = weather.strength
    grey = np.full(3, frame.air.mean())
    veiled = _veiled(
        replace(image, radiance=_flattened(image.radiance, 0.5 * s)),
        visibility_m(s, 20_000.0, 600.0) * _breathing(weather, frame.time_s),
        0.85 * grey,
    )
    flakes = Flakes(count=round(90_000 * s), size_m=0.007, fall_m_s=1.3, drift_m_s=0.8 * frame.wind_m_s, sway_m=0.15)
    layer = falling(flakes, frame.camera, frame.T_camera_world, frame.time_s, 1.0 / 250.0, weather.seed)[..., None]
    white = np.float32(1.15 * grey.mean())
    return replace(veiled, radiance=(veiled.radiance * (1.0 - layer) + white * layer).astype(np.float32)), sensor


def _glare(image: LinearImage, sensor: Sensor, weather: Weather, frame: Circumstances) -> tuple[LinearImage, Sensor]:
    """Sun on the lens: a veil about its image, and highlights that bleed."""
    s = weather.strength
    towards = frame.T_camera_world[:3, :3] @ frame.sun_world
    K, (height, width) = frame.camera.K, image.distance.shape
    x, y = towards[0], min(towards[1], -0.05)  # a low sun is above the picture, wherever it is
    depth = max(float(abs(towards[2])), 0.25)
    centre = np.array([K[0, 0] * x / depth + K[0, 2], K[1, 1] * y / depth + K[1, 2]])
    centre = np.clip(centre, [-0.05 * width, -0.12 * height], [1.05 * width, 1.0 * height])
    rows, columns = np.arange(height)[:, None], np.arange(width)[None, :]
    off = np.hypot(columns - centre[0], rows - centre[1]) / max(height, width)
    white = np.float32(1.0 / sensor.exposure)
    veil = (3.5 * np.exp(-off / 0.14) + 1.5 * np.exp(-off / 0.5)) * s
    tint = np.array([1.0, 0.94, 0.84], np.float32)
    bright = np.minimum(np.maximum(image.radiance - 0.5 * white, 0.0), 20.0 * white)
    bleeding = sum(blurred(bright, k * max(height, width) / 256.0) for k in (1.5, 6.0, 20.0))
    light = image.radiance + veil.astype(np.float32)[..., None] * tint * white + np.float32(0.25 * s) * bleeding
    return replace(image, radiance=light.astype(np.float32)), replace(sensor, exposure=sensor.exposure * (1 - 0.3 * s))


def _dusk(image: LinearImage, sensor: Sensor, weather: Weather, _: Circumstances) -> tuple[LinearImage, Sensor]:
    """Little light, blue from above, orange along the horizon; the camera opens up as far as it can."""
    s = weather.strength
    sky = _far(image)
    warm, cold = np.array([1.25, 0.82, 0.50], np.float32), np.array([0.72, 0.84, 1.18], np.float32)
    tint = 1.0 + s * (cold + sky * (warm - cold) - 1.0)
    light = _flattened(image.radiance, 0.75 * s) * tint * (1.0 - 0.55 * s * (1.0 - sky))
    dark = 10.0 ** (-1.7 * s)
    set_for = replace(sensor, exposure=sensor.exposure * 0.55**s / dark, full_well=sensor.full_well * dark**0.6)
    return replace(image, radiance=(light * dark).astype(np.float32)), set_for


def _night(image: LinearImage, sensor: Sensor, weather: Weather, _: Circumstances) -> tuple[LinearImage, Sensor]:
    """Moonlight: hardly any colour, and a picture full of noise."""
    s = weather.strength
    sky = _far(image)
    grey = image.radiance.mean(axis=2, keepdims=True)
    light = grey + (1.0 - 0.8 * s) * (image.radiance - grey)
    tint = np.array([0.70, 0.88, 1.20], np.float32)
    light = light * (1.0 + s * (tint - 1.0)) * (1.0 - 0.6 * s * sky)
    dark = 10.0 ** (-3.5 * s)
    set_for = replace(
        sensor,
        exposure=sensor.exposure * 0.16**s / dark,
        full_well=max(60.0, sensor.full_well * 0.012**s),
        read_noise=2.0 + sensor.read_noise * 0.3,
    )
    return replace(image, radiance=(light * dark).astype(np.float32)), set_for


def _low_contrast(
    image: LinearImage, sensor: Sensor, weather: Weather, frame: Circumstances
) -> tuple[LinearImage, Sensor]:
    """Haze and a dirty window: everything drawn towards one grey."""
    level = np.float32(0.55 / sensor.exposure)
    keep = np.float32(1.0 - 0.85 * weather.strength)
    veiled = _veiled(image, visibility_m(weather.strength, 40_000.0, 6_000.0), frame.air)
    return replace(veiled, radiance=(level + (veiled.radiance - level) * keep).astype(np.float32)), sensor


def _far(image: LinearImage) -> np.ndarray:
    """1 in the sky, 0 below, with no edge at the horizon; (h, w, 1)."""
    return np.clip(image.distance / (0.7 * FAR_M) - 0.3, 0.0, 1.0).astype(np.float32)[..., None]


def _flattened(radiance: Radiance, share: float) -> Radiance:
    """Direct light exchanged for diffuse: highlights compressed, colours paler."""
    grey = radiance.mean(axis=2, keepdims=True)
    soft = np.float32(0.25) * np.log1p(radiance / np.float32(0.25))
    return (radiance + np.float32(share) * (0.8 * soft + 0.2 * grey - radiance)).astype(np.float32)


_APPLY: dict[str, Callable[[LinearImage, Sensor, Weather, Circumstances], tuple[LinearImage, Sensor]]] = {
    "fog": _fog,
    "rain": _rain,
    "snow": _snow,
    "glare": _glare,
    "dusk": _dusk,
    "night": _night,
    "low-contrast": _low_contrast,
}
