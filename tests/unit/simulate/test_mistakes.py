# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest

from fairlead.simulate import Outliers, Swaps
from fairlead.simulate.streams import Streams

T = np.arange(2000) / 25.0


def test_a_share_is_off_by_the_distance(ship):
    """10 % of 40,000 within 4 standard errors, each 30 px off; the mean direction vanishes."""
    pixels = np.zeros((2000, 20, 2))
    off = np.linalg.norm(Outliers(share=0.1).spoil(pixels, T, ship[1], Streams(1)), axis=2)
    assert (off > 0).mean() == pytest.approx(0.1, abs=4 * np.sqrt(0.09 / 40_000))
    np.testing.assert_allclose(off[off > 0], 30.0)
    normal = Outliers(share=1.0, kind="normal", size_px=7.0).spoil(pixels, T, ship[1], Streams(1))
    assert normal.std() == pytest.approx(7.0, rel=0.02)
    anywhere = Outliers(share=1.0, kind="image").spoil(pixels, T, ship[1], Streams(1))
    assert anywhere.min() > -0.5
    assert anywhere.max() < 1023.5
    assert anywhere.mean() == pytest.approx(511.5, abs=4 * 1024 / np.sqrt(12 * 80_000))


def test_the_same_mistake_lasts(ship):
    """Held for 0.4 s on average: a spoilt observation that stays spoilt is off by the same, ten images on average."""
    pixels = np.zeros((2000, 20, 2))
    spoilt = Outliers(share=0.2, hold_s=0.4).spoil(pixels, T, ship[1], Streams(2))
    wrong = np.linalg.norm(spoilt, axis=2) > 0
    both = wrong[1:] & wrong[:-1]
    same = (spoilt[1:] == spoilt[:-1]).all(axis=2)
    assert same[both].all()
    ends = (wrong[:-1] & ~wrong[1:]).sum()
    assert wrong[:-1].sum() / ends == pytest.approx(10.0, rel=0.15)


def test_pairs_go_by_one_another_s_name(ship):
    """The two halves of a pair swap in a tenth of the images, never one alone; nobody else is touched."""
    target = ship[0]
    swaps = Swaps(share=0.1, pairs=(("wing_p", "wing_s"), ("stern_p", "stern_s")))
    order = swaps.order(target, np.zeros((2000, 20, 2)), T, Streams(3))
    p, s = target.landmarks.index("wing_p"), target.landmarks.index("wing_s")
    swapped = order[:, p] == s
    np.testing.assert_array_equal(order[:, s] == p, swapped)
    assert swapped.mean() == pytest.approx(0.1, abs=4 * np.sqrt(0.09 / 2000))
    others = [j for j, name in enumerate(target.landmarks) if name[:-2] not in ("wing", "stern")]
    np.testing.assert_array_equal(order[:, others], np.tile(others, (2000, 1)))
    together = replace(swaps, together=True).order(target, np.zeros((2000, 20, 2)), T, Streams(3))
    q = target.landmarks.index("stern_p")
    np.testing.assert_array_equal(together[:, p] != p, together[:, q] != q)


def test_without_pairs_the_nearest_is_taken(ship):
    """Four points on a line at 0, 1, 3, 3.5: 0 and 1 are each other's nearest, and 3 and 3.5."""
    box = replace(
        ship[0], landmarks=("a", "b", "c", "d"), positions=np.eye(4, 3), covariance=np.eye(12), touchdown=None
    )
    pixels = np.zeros((500, 4, 2))
    pixels[..., 0] = [0.0, 1.0, 3.0, 3.5]
    order = Swaps(share=0.3).order(box, pixels, T[:500], Streams(4))
    assert {tuple(row) for row in order.tolist()} == {(0, 1, 2, 3), (1, 0, 2, 3), (0, 1, 3, 2), (1, 0, 3, 2)}
    # a pair swaps if either of its landmarks is chosen
    assert (order[:, 0] == 1).mean() == pytest.approx(1 - 0.7**2, abs=4 * np.sqrt(0.25 / 500))
    assert Swaps().order(box, pixels, T[:500], Streams(4)) is None


def test_impossible_mistakes_are_refused(ship):
    with pytest.raises(ValueError, match="share: expected a share"):
        Outliers(share=1.5)
    with pytest.raises(ValueError, match="pairs: expected two different"):
        Swaps(pairs=(("bow", "bow"),))
    with pytest.raises(ValueError, match="pairs: expected landmarks of frigate, got 'keel'"):
        Swaps(pairs=(("bow", "keel"),)).columns(ship[0])
