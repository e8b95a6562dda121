# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Detections that are wrong altogether: outliers, landmarks taken for one another. docs/simulate.md eq. (24), (25)."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float64, Int

from fairlead.simulate.limits import expect, expect_at_least_zero, expect_share
from fairlead.simulate.outages import draw_outages, first_of_run
from fairlead.simulate.rotations import Times
from fairlead.simulate.streams import Streams
from fairlead.types import Camera, Target

ImagePoints = Float64[np.ndarray, "k n 2"]
Order = Int[np.ndarray, "k n"]


@dataclass(frozen=True, kw_only=True)
class Outliers:
    """Observations that have nothing to do with their landmark. The detector does not know."""

    share: float = 0.0
    """Of the observations [-]."""
    kind: Literal["ring", "normal", "image"] = "ring"
    """ring: off by size_px, any direction. normal: Gaussian, size_px each coordinate. image: anywhere in the image."""
    size_px: float = 30.0
    """How far off, on top of the noise [px]."""
    hold_s: float = 0.0
    """How long the same mistake lasts on average; 0: each image by itself [s]."""

    def __post_init__(self) -> None:
        expect_share("share", self.share)
        expect_at_least_zero("size_px", self.size_px)
        expect_at_least_zero("hold_s", self.hold_s)

    def spoil(self, pixels: ImagePoints, turns: Times, camera: Camera, streams: Streams) -> ImagePoints:
        """The observations with a share of them spoilt, eq. (24)."""
        if self.share == 0.0:
            return pixels
        wrong = draw_outages(turns, pixels.shape[1], self.share, self.hold_s, streams.of("outliers"))
        began = first_of_run(wrong, held=self.hold_s > 0.0)
        rng = streams.of("outlier_offsets")
        if self.kind == "image":
            spoilt = rng.random(pixels.shape) * np.array([camera.width, camera.height]) - 0.5
            return np.where(wrong[..., None], np.take_along_axis(spoilt, began[..., None], axis=0), pixels)
        if self.kind == "normal":
            offsets = self.size_px * rng.standard_normal(pixels.shape)
        else:
            directions = rng.uniform(0.0, 2.0 * np.pi, pixels.shape[:2])
            offsets = self.size_px * np.stack([np.cos(directions), np.sin(directions)], axis=2)
        return pixels + np.where(wrong[..., None], np.take_along_axis(offsets, began[..., None], axis=0), 0.0)


@dataclass(frozen=True, kw_only=True)
class Swaps:
    """Landmarks that are taken for one another."""

    share: float = 0.0
    """Chance of each pair in each image [-]."""
    pairs: tuple[tuple[str, str], ...] = ()
    """Which; if none is named, each landmark and the one that is nearest to it in the image."""
    together: bool = False
    """All pairs at once, as where a target is taken for its mirror image."""
    hold_s: float = 0.0
    """How long a mistake lasts on average; 0: each image by itself [s]."""

    def __post_init__(self) -> None:
        expect_share("share", self.share)
        expect_at_least_zero("hold_s", self.hold_s)
        for pair in self.pairs:
            expect("pairs", list(pair), "two different landmarks", when=pair[0] != pair[1])

    def order(self, target: Target, pixels_true: ImagePoints, turns: Times, streams: Streams) -> Order | None:
        """Whose observation goes by the name of each landmark, (k, n); None if every name is right. Eq. (25)."""
        if self.share == 0.0:
            return None
        named = self.columns(target)
        n = len(target.landmarks)
        chains = 1 if self.together else len(named) or n
        swapped = draw_outages(turns, chains, self.share, self.hold_s, streams.of("swaps"))
        order = np.tile(np.arange(n), (len(turns), 1))
        for k in np.flatnonzero(swapped.any(axis=1)):
            pairs = named or _nearest_pairs(pixels_true[k])
            chosen = pairs if self.together else [pairs[chain] for chain in np.flatnonzero(swapped[k])]
            for i, j in dict.fromkeys(chosen):
                order[k, [i, j]] = order[k, [j, i]]
        return order

    def columns(self, target: Target) -> list[tuple[int, int]]:
        """Places of the named pairs in the target. Raises ValueError for a landmark that is not there."""
        for pair in self.pairs:
            for name in pair:
                expect("pairs", name, f"landmarks of {target.name}", when=name in target.landmarks)
        return [(target.landmarks.index(a), target.landmarks.index(b)) for a, b in self.pairs]


def _nearest_pairs(pixels: Float64[np.ndarray, "n 2"]) -> list[tuple[int, int]]:
    """Each landmark and the other one that is nearest to it in one image, the smaller number first."""
    squares = ((pixels[:, None] - pixels) ** 2).sum(axis=2)
    squares[np.isnan(squares)] = np.inf
    np.fill_diagonal(squares, np.inf)
    return [(min(i, j), max(i, j)) for i, j in enumerate(np.argmin(squares, axis=1).tolist())]
