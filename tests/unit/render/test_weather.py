# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Weather, sensor and sea by what physics says of them."""

from dataclasses import replace

import numpy as np
import pytest

from fairlead.opencv.filters import blurred, resized
from fairlead.render.images import FAR_M, LinearImage
from fairlead.render.noise import fractal_tile
from fairlead.render.ocean import GRAVITY, TILES_M, WaveField
from fairlead.render.precipitation import Flakes, falling
from fairlead.render.sensor import Sensor, develop, exposure_for, tone_curve
from fairlead.render.wake import Hull, make_wake
from fairlead.render.weather import KINDS, Circumstances, Weather, apply_weather, visibility_m
from tests.unit.render.conftest import pinhole

FRAME = Circumstances(
    camera=pinhole(64, 100.0),
    T_camera_world=np.array([[0.0, -1, 0, 0], [0, 0, -1, 50], [1, 0, 0, 0], [0, 0, 0, 1]]),
    time_s=3.0,
    air=np.array([0.4, 0.42, 0.45]),
    sun_world=np.array([0.8, 0.0, 0.6]),
)
PLAIN = Sensor(exposure=1.0)


def board(distance_m: float = 1000.0) -> LinearImage:
    """Black and white halves at one distance under a strip of sky."""
    radiance = np.full((64, 64, 3), 0.02, np.float32)
    radiance[:, 32:] = 0.8
    radiance[:10] = 0.6
    distance = np.full((64, 64), distance_m, np.float32)
    distance[:10] = FAR_M
    return LinearImage(radiance=radiance, distance=distance)


def contrast(image: LinearImage) -> float:
    left, right = image.radiance[20:, 4:28].mean(), image.radiance[20:, 36:60].mean()
    return float((right - left) / (right + left))


@pytest.mark.parametrize("kind", KINDS)
def test_weather_is_repeatable_and_none_of_it_is_nothing(kind: str) -> None:
    weather = Weather(kind=kind, strength=0.6, seed=4)
    image, sensor = apply_weather(board(), PLAIN, weather, FRAME)
    again, _ = apply_weather(board(), PLAIN, weather, FRAME)
    assert np.array_equal(image.radiance, again.radiance)
    assert image.radiance.dtype == np.float32
    assert np.isfinite(image.radiance).all()
    assert image.radiance.min() >= 0.0
    clear, same = apply_weather(board(), PLAIN, replace(weather, strength=0.0), FRAME)
    # Below the sky, over one kilometre: 15 km of visibility leave exp(-3.912 / 15) = 0.77.
    assert np.abs(clear.radiance - board().radiance)[10:].max() < (1.0 - 0.77) * 0.8
    changed = np.abs(image.radiance * sensor.exposure - board().radiance).max()
    assert changed > 0.05
    assert same.exposure == pytest.approx(1.0)


def test_fog_takes_contrast_as_koschmieder_says() -> None:
    """At the visibility the contrast is exp(-3.912) = 2 % of what it was, against air of the same radiance."""
    weather = Weather(kind="fog", strength=0.8)
    near, _ = apply_weather(board(100.0), PLAIN, weather, replace(FRAME, time_s=0.0))
    visibility = visibility_m(0.8, 30_000.0, 400.0) * (1.0 + 0.1 * np.sin(0.0) * np.sin(0.0))
    far, _ = apply_weather(board(visibility), PLAIN, weather, replace(FRAME, time_s=0.0))
    span = [float(np.ptp(image.radiance[40, :, 1])) for image in (near, far)]
    assert span[1] / span[0] == pytest.approx(np.exp(-3.912 * (1.0 - 100.0 / visibility)), rel=0.01)
    assert contrast(far) < contrast(near)


def test_more_fog_is_less_contrast() -> None:
    values = [
        contrast(apply_weather(board(), PLAIN, Weather(kind="fog", strength=s), FRAME)[0]) for s in (0.0, 0.3, 0.6, 1.0)
    ]
    assert values == sorted(values, reverse=True)


def test_nights_are_dark_and_noisy() -> None:
    image, sensor = apply_weather(board(), PLAIN, Weather(kind="night", strength=1.0), FRAME)
    day = develop(board().radiance, PLAIN, np.random.default_rng(0)).astype(float)
    night = develop(image.radiance, sensor, np.random.default_rng(0)).astype(float)
    assert night.mean() < 0.5 * day.mean()
    patch = np.s_[20:, 36:60]
    assert night[patch].std() / night[patch].mean() > 3.0 * day[patch].std() / day[patch].mean()


def test_flakes_go_on_falling_from_frame_to_frame() -> None:
    """A little later the same flakes are a little lower: the layers of both times fit best when shifted down."""
    camera = pinhole(128, 120.0)
    flakes = Flakes(count=4000, size_m=0.02, fall_m_s=1.3, drift_m_s=0.0, sway_m=0.0)
    one, two = (falling(flakes, camera, FRAME.T_camera_world, t, 1e-3, 1) for t in (5.0, 5.02))
    scores = [float((one[:120] * np.roll(two, -shift, 0)[:120]).sum()) for shift in range(-4, 8)]
    assert int(np.argmax(scores)) - 4 >= 1
    assert one.max() <= 1.0


def test_a_strength_beyond_the_worst_is_refused() -> None:
    with pytest.raises(ValueError, match="strength"):
        Weather(kind="fog", strength=1.5)


def test_noise_is_that_of_the_electrons() -> None:
    """Shot and read noise, sqrt(x / N + (r / N)^2) of the exposed radiance, through the slope of the tone curve."""
    sensor = Sensor(exposure=1.0, blur_px=0.0, full_well=1000.0, read_noise=10.0, vignetting=0.0, bloom=0.0)
    flat = np.full((200, 200, 3), 0.3, np.float32)
    picture = develop(flat, sensor, np.random.default_rng(0)).astype(float) / 255.0
    slope = float(np.diff(tone_curve(np.array([0.299, 0.301])))[0]) / 0.002
    expected = slope * np.sqrt(0.3 / 1000.0 + (10.0 / 1000.0) ** 2)
    assert picture.std() == pytest.approx(expected, rel=0.03)
    assert picture.mean() == pytest.approx(float(tone_curve(np.array([0.3]))[0]), abs=0.01)


def test_a_meter_makes_a_grey_wall_grey() -> None:
    assert exposure_for(2.0) * 2.0 / np.pi == pytest.approx(exposure_for(0.02) * 0.02 / np.pi)
    assert 0.6 < float(tone_curve(np.array([0.5]))[0]) < 0.9
    assert np.all(np.diff(tone_curve(np.linspace(0.0, 1.5, 100))) > 0.0)


def test_waves_have_the_height_of_their_wind() -> None:
    """Pierson and Moskowitz: significant height 4 sigma = 0.21 U^2 / g, at 19.5 m; U is at 10 m, 1.026 times less."""
    wind = 9.0
    waves = WaveField(wind, 0.4, 1).at(0.0)
    height = 4.0 * np.sqrt(sum(float(tile.displacement[..., 2].var()) for tile in waves.tiles))
    assert height == pytest.approx(0.21 * wind**2 / GRAVITY, rel=0.15)


def test_slopes_are_those_of_the_height() -> None:
    tile = WaveField(9.0, 0.4, 1).at(2.0).tiles[0]
    step = TILES_M[0] / len(tile.slope)
    dz = (np.roll(tile.displacement[..., 2], -1, 1) - np.roll(tile.displacement[..., 2], 1, 1)) / (2 * step)
    # The shortest wave of the first tile has 7 samples: central differences lose sin(x)/x of it, 13 %.
    assert np.corrcoef(dz.ravel(), tile.slope[..., 0].ravel())[0, 1] > 0.99
    assert dz.std() == pytest.approx(tile.slope[..., 0].std(), rel=0.15)


def test_waves_run_with_the_wind() -> None:
    field = WaveField(9.0, 0.0, 1)
    first, later = (field.at(t).tiles[0].displacement[..., 2] for t in (0.0, 0.5))
    shifts = range(-3, 4)
    scores = [float((first * np.roll(later, -s, 1)).sum()) for s in shifts]
    assert shifts[int(np.argmax(scores))] >= 1


def test_the_wake_is_at_the_stern_and_symmetric() -> None:
    hull = Hull(stern=0.0, bow=130.0, beam=16.0)
    near, far = make_wake(hull, 9.0)
    foam = far.sample(np.array([-10.0, -60.0, 300.0, -10.0]), np.array([0.0, 0.0, 0.0, 60.0]))[:, 0]
    assert foam[0] > 0.6
    assert foam[0] > foam[1] > foam[2] == 0.0
    assert foam[3] < 0.05
    assert np.allclose(near.image[:, :, 0], near.image[::-1, :, 0], atol=1e-6)
    assert np.allclose(near.image[:, :, 2], -near.image[::-1, :, 2], atol=1e-6)
    assert not make_wake(hull, 0.0)[0].image.any()


def test_kelvin_waves_are_as_long_as_the_speed_wants() -> None:
    """Transverse waves on the axis: 2 pi U^2 / g."""
    speed = 9.0
    _, far = make_wake(Hull(stern=0.0, bow=130.0, beam=16.0), speed)
    x = np.linspace(-700.0, -100.0, 2048)
    slope = far.sample(x, np.zeros_like(x))[:, 1]
    spectrum = np.abs(np.fft.rfft(slope * np.hanning(len(x))))
    wave_number = 2.0 * np.pi * np.fft.rfftfreq(len(x), x[1] - x[0])[np.argmax(spectrum)]
    assert 2.0 * np.pi / wave_number == pytest.approx(2.0 * np.pi * speed**2 / GRAVITY, rel=0.1)


def test_noise_tiles_without_a_seam() -> None:
    tile = fractal_tile(64, 2.0, np.random.default_rng(0)).astype(float)
    inner, seam = np.abs(np.diff(tile, axis=1)).mean(), np.abs(tile[:, 0] - tile[:, -1]).mean()
    assert seam < 1.3 * inner


def test_resizing_keeps_the_centres() -> None:
    """A ramp u stays a ramp: pixel k of half the size lies at 2 k + 1/2."""
    ramp = np.tile(np.arange(16, dtype=np.float32)[None, :, None], (16, 1, 3))
    assert np.allclose(resized(ramp, 8, 8)[4, :, 0], 2.0 * np.arange(8) + 0.5)
    assert np.allclose(resized(ramp, 32, 32)[4, 2:-2, 0], 0.5 * np.arange(32)[2:-2] - 0.25)
    assert blurred(ramp, 0.0) is ramp
