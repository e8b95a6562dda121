# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Crops: where a pixel goes, and comes back to, to a fraction of a pixel."""

import numpy as np
import pytest

from fairlead.detect.window import Window, window_about


def blob(width: int, height: int, z: tuple[float, float], sigma: float) -> np.ndarray:
    """A Gaussian on black whose middle is at z, pixel (0, 0) being the centre of the top-left one."""
    v, u = np.mgrid[:height, :width]
    bell = np.exp(-0.5 * ((u - z[0]) ** 2 + (v - z[1]) ** 2) / sigma**2)
    return np.repeat(np.round(255.0 * bell)[..., None], 3, axis=2).astype(np.uint8)


def centre_of_mass(image: np.ndarray) -> np.ndarray:
    grey = image[..., 0].astype(np.float64)
    v, u = np.mgrid[: grey.shape[0], : grey.shape[1]]
    return np.array([(grey * u).sum(), (grey * v).sum()]) / grey.sum()


WINDOWS = [
    pytest.param(Window(corner=(100, 60), extent=(64, 64), size=(256, 256)), id="four times larger"),
    pytest.param(Window(corner=(90, 50), extent=(87, 87), size=(256, 256)), id="larger, no whole factor"),
    pytest.param(Window(corner=(20, 10), extent=(256, 256), size=(256, 256)), id="as it is"),
    pytest.param(Window(corner=(5, 3), extent=(256, 256), size=(64, 64)), id="four times smaller"),
    pytest.param(Window(corner=(-30, -41), extent=(301, 301), size=(128, 128)), id="smaller, off the image"),
    pytest.param(Window(corner=(40, 20), extent=(150, 200), size=(48, 64)), id="three to four"),
]


@pytest.mark.parametrize("window", WINDOWS)
def test_a_point_of_the_image_is_where_the_window_says(window: Window) -> None:
    z = (131.3, 91.8)
    crop = window.cut(blob(320, 240, z, 5.0))
    assert crop.shape == (window.size[1], window.size[0], 3)
    expected = window.to_crop(np.array([z]))[0]
    # 8 bit rounding and bilinear weights; half a pixel of the image or of the crop is far outside.
    assert centre_of_mass(crop) == pytest.approx(expected, abs=0.03 * max(1.0, window.scale.max()))
    assert window.to_image(centre_of_mass(crop)[None])[0] == pytest.approx(z, abs=0.03 / min(1.0, window.scale.min()))


@pytest.mark.parametrize("window", WINDOWS)
def test_there_and_back(window: Window) -> None:
    z = np.random.default_rng(0).uniform(-50.0, 400.0, (20, 2))
    assert window.to_image(window.to_crop(z)) == pytest.approx(z, abs=1e-9)


def test_corners_of_the_window_are_corners_of_the_crop() -> None:
    window = Window(corner=(10, 20), extent=(100, 50), size=(200, 200))
    corners = window.to_crop(np.array([[9.5, 19.5], [109.5, 69.5]]))
    assert corners == pytest.approx(np.array([[-0.5, -0.5], [199.5, 199.5]]))


def test_covariances_go_with_the_pixels() -> None:
    window = Window(corner=(10, 20), extent=(100, 50), size=(200, 200))
    S = np.array([[[4.0, 1.0], [1.0, 2.0]]])
    moved = window.covariances_to_image(S)
    rng = np.random.default_rng(1)
    draws = rng.multivariate_normal([50.0, 60.0], S[0], size=200_000)
    assert moved[0] == pytest.approx(np.cov(window.to_image(draws).T), rel=0.02)


def test_shrinking_takes_the_mean_of_all_pixels() -> None:
    checks = (np.indices((256, 256)).sum(axis=0) % 2 * 255).astype(np.uint8)
    image = np.repeat(checks[..., None], 3, axis=2)
    for extent in (256, 230):
        crop = Window(corner=(0, 0), extent=(extent, extent), size=(32, 32)).cut(image)
        assert np.ptp(crop.astype(int)) <= 4
        assert crop.mean() == pytest.approx(127.5, abs=2.0)


def test_beyond_the_image_its_edge_goes_on() -> None:
    image = np.zeros((40, 60, 3), np.uint8)
    image[:, :30], image[:, 30:] = 10, 200
    crop = Window(corner=(-20, -20), extent=(100, 80), size=(100, 80)).cut(image)
    assert (crop[:, :50] == 10).all()
    assert (crop[:, 50:] == 200).all()
    for corner in ((500, 500), (-500, 0), (0, -500)):
        beyond = Window(corner=corner, extent=(32, 32), size=(32, 32)).cut(image)
        assert (beyond == (200 if corner[0] > 0 else 10)).all() or corner[1] < 0


def test_a_window_about_a_point_holds_the_square() -> None:
    window = window_about(np.array([100.2, 50.7]), 60.0, (192, 256))
    assert window.extent == (60, 80)
    middle = window.to_crop(np.array([[100.2, 50.7]]))[0]
    assert middle == pytest.approx([95.5, 127.5], abs=0.5 * 192 / 60 + 1e-9)
    assert min(window_about(np.array([0.0, 0.0]), 1.0, (256, 256)).extent) == 16
