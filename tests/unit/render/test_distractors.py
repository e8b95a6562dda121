# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Other ships float, point forward, and are never the same twice."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fairlead.render.distractors import KINDS, other_ship
from fairlead.render.surface import Surface


@pytest.mark.parametrize("build", [build for build, _ in KINDS])
def test_a_ship_floats_and_points_forward(build: Callable[[np.random.Generator], Surface]) -> None:
    for seed in range(20):
        low, high = build(np.random.default_rng(seed)).corners
        length = high[0] - low[0]
        assert 6.0 < length < 340.0
        assert low[2] < 0.0 < high[2] < 2.0 * length  # some of it under water, the mast not endless
        assert -0.12 * length < low[0] < 0.3 * length  # the stern at the origin
        assert high[1] - low[1] < 0.9 * length


def test_no_two_ships_are_alike() -> None:
    rng = np.random.default_rng(0)
    ships = [other_ship(rng) for _ in range(30)]
    extents = np.array([np.subtract(*ship.corners[::-1]) for ship in ships])
    apart = np.linalg.norm(extents[:, None] - extents, axis=2) + 1e9 * np.eye(len(ships))
    assert apart.min() > 1e-3
    assert len({tuple(ship.materials[0].colour) for ship in ships}) == len(ships)


def test_a_stand_in_is_seen_where_the_target_would_be(graphics: None, repository: Path, tmp_path: Path) -> None:
    """Some of the crops without it show open sea, others a ship."""
    from fairlead.cli import main
    from fairlead.opencv import read_image

    target = str(repository / "data" / "frigate" / "target.toml")
    main(["render", "crops", "--target", target, "--count", "24", "--size", "64", "--empty", "1", "-o", str(tmp_path)])
    pictures = [read_image(path).astype(float) for path in sorted((tmp_path / "images").iterdir())]
    middles = [picture[16:48, 16:48].mean(axis=2) for picture in pictures]
    assert np.ptp([middle.std() for middle in middles]) > 5.0
