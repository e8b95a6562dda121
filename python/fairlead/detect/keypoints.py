# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What a network says of the landmarks of one window."""

from dataclasses import dataclass, replace
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool

from fairlead.detect.window import Window
from fairlead.io.network_card import NetworkCard
from fairlead.opencv import Image
from fairlead.types import PixelCovariances, Pixels, Scores


@dataclass(frozen=True, kw_only=True, eq=False)
class Keypoints:
    """Every landmark of the network, seen or not, in the network's order."""

    pixels: Pixels
    covariances: PixelCovariances
    scores: Scores
    """Logit of being seen, or height of the peak."""

    def in_image(self, window: Window) -> "Keypoints":
        """From pixels of the crop to those of the image, covariances with them, docs/detect.md eq. (1) and (2)."""
        return replace(
            self, pixels=window.to_image(self.pixels), covariances=window.covariances_to_image(self.covariances)
        )

    def above(self, threshold: float) -> Bool[np.ndarray, "n"]:
        """Which are seen: a score above the threshold, and finite numbers with a positive definite covariance."""
        S = self.covariances
        with np.errstate(invalid="ignore", over="ignore"):
            definite = (S[:, 0, 0] > 0.0) & (S[:, 0, 0] * S[:, 1, 1] - S[:, 0, 1] * S[:, 1, 0] > 0.0)
            return (
                (self.scores > threshold)
                & np.isfinite(self.pixels).all(axis=1)
                & np.isfinite(S).all(axis=(1, 2))
                & definite
            )


@runtime_checkable
class LandmarkNetwork(Protocol):
    """What acquiring and following need of a network."""

    card: NetworkCard
    size: tuple[int, int]
    """Width and height of a crop [px]."""

    def look(self, crop: Image) -> Keypoints:
        """Keypoints of a crop, in its pixels."""
        ...
