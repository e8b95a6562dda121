# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Labels move with the picture, to a fraction of a pixel."""

import numpy as np
import pytest

from fairlead.train.augment import NONE, Augmentation, augment

TURNED = Augmentation(rotation_deg=25.0, scale=0.2, shift=0.05, patches=0.0, colour=0.0, noise=0.0)


def spots(places: np.ndarray, side: int) -> np.ndarray:
    """A round spot of its own colour at each of three places, on black."""
    v, u = np.mgrid[:side, :side]
    spots = [np.exp(-0.5 * ((u - x) ** 2 + (v - y) ** 2) / 4.0**2) for x, y in places]
    return np.rint(255.0 * np.stack(spots, axis=-1)).astype(np.uint8)


def middles(image: np.ndarray, about: np.ndarray) -> np.ndarray:
    """Middle of each spot; what the picture does not reach is grey, and far from them."""
    v, u = np.mgrid[: image.shape[0], : image.shape[1]]
    found = []
    for k, (x, y) in enumerate(about):
        weights = image[..., k] * (np.hypot(u - x, v - y) < 14.0)
        found.append([(weights * each).sum() / weights.sum() for each in (u, v)])
    return np.array(found)


PLACES = np.array([[100.0, 120.0], [150.5, 131.25], [120.0, 90.0]])
SEEN = np.array([2, 1, 2])


def test_nothing_drawn_is_nothing_changed() -> None:
    image = spots(PLACES, 256)
    crop, pixels, seen = augment(image, PLACES, SEEN, size=256, spread=NONE, rng=np.random.default_rng(0))
    assert (crop == image).all()
    assert np.allclose(pixels, PLACES)
    assert (seen == SEEN).all()


@pytest.mark.parametrize("size", [256, 192, 128])
@pytest.mark.parametrize("seed", range(4))
def test_labels_stay_on_what_they_label(size: int, seed: int) -> None:
    """0.05 px: what 8 bits, bilinear interpolation and the end of the spots leave."""
    rng = np.random.default_rng(seed)
    crop, pixels, seen = augment(spots(PLACES, 256), PLACES, SEEN, size=size, spread=TURNED, rng=rng)
    assert crop.shape == (size, size, 3)
    assert (seen == SEEN).all()
    assert np.abs(middles(crop, pixels) - pixels).max() < 0.05


def test_what_leaves_the_crop_or_is_covered_is_said() -> None:
    far = Augmentation(rotation_deg=0.0, scale=0.0, shift=0.5, patches=0.0, colour=0.0, noise=0.0)
    patched = Augmentation(rotation_deg=0.0, scale=0.0, shift=0.0, patches=1.0, colour=0.0, noise=0.0)
    left, covered = 0, 0
    for seed in range(30):
        args = {"size": 256, "rng": np.random.default_rng(seed)}
        _, pixels, seen = augment(spots(PLACES, 256), PLACES, SEEN, spread=far, **args)
        inside = ((pixels > -0.5) & (pixels < 255.5)).all(axis=1)
        assert (seen == np.where(inside, SEEN, 0)).all()
        left += (~inside).sum()
        crop, _, seen = augment(spots(PLACES, 256), PLACES, SEEN, spread=patched, **args)
        for k in (0, 2):
            u, v = PLACES[k].astype(int)
            assert (seen[k] == 2) == (crop[v, u, k] == 255)
            covered += seen[k] == 1
    assert left > 5
    assert covered > 2
