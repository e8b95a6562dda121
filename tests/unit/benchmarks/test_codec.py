# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The displacement that a codec is judged by."""

import numpy as np
import pytest

from benchmarks.codec import RADIUS_PX, shift


def corner(at: tuple[float, float]) -> np.ndarray:
    """A bright quadrant with soft edges, its tip at a pixel of the window."""
    y, x = np.mgrid[-1.0 : 2 * RADIUS_PX + 2, -1.0 : 2 * RADIUS_PX + 2]
    return 60.0 + 120.0 / (1.0 + np.exp(-(x - at[0]))) / (1.0 + np.exp(-(y - at[1])))


@pytest.mark.parametrize("moved", [(0.1, 0.0), (0.0, -0.2), (-0.15, 0.3)])
def test_a_moved_corner_is_found_to_a_tenth_of_its_motion(moved: tuple[float, float]) -> None:
    """One step of least squares; brightness does not count."""
    centre = (RADIUS_PX + 0.3, RADIUS_PX - 0.4)
    after = 5.0 + corner((centre[0] + moved[0], centre[1] + moved[1]))
    assert shift(corner(centre), after, centre) == pytest.approx(np.array(moved), abs=0.1 * np.linalg.norm(moved))


def test_noise_moves_nothing_in_the_mean() -> None:
    """300 draws of 1 level: by least squares each coordinate has 1 / sqrt(sum w g^2) px about it."""
    rng, centre = np.random.default_rng(0), (RADIUS_PX + 0.0, RADIUS_PX + 0.0)
    clean = corner(centre)
    found = np.array([shift(clean, clean + rng.standard_normal(clean.shape), centre) for _ in range(300)])
    assert np.abs(found.mean(axis=0)).max() < 4.0 * found.std() / np.sqrt(300)
    assert 0.001 < found.std() < 0.02
