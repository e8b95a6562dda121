# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A stand-in for a trained network that errs as trained ones do, on images whose pixels say where they are.

Red and green are ramps along u and v, so that a crop tells its own window, and what the stand-in is shown is
known without an image of the target. Its errors grow and its logits fall where the target is not of the size that a
network is trained on; its errors have heavy tails; what it does not find it puts anywhere, with a low logit.
"""

import numpy as np

from fairlead import geometry
from fairlead.detect.keypoints import Keypoints
from fairlead.io.network_card import NetworkCard, NetworkInput
from fairlead.opencv import Image
from fairlead.types import Camera, Matrix4, Points3

TRAINED_PX = 256 / 1.25
LEVELS_PER_PX = 0.25


def ramps(side: int = 1024) -> Image:
    """An image whose red is a quarter of u and whose green is a quarter of v."""
    v, u = np.mgrid[:side, :side]
    return np.stack([np.zeros_like(u), v // 4, u // 4], axis=-1).astype(np.uint8)


def ramp(values: np.ndarray) -> tuple[float, float] | None:
    """Slope and level at 0 of a ramp, where it is not cut off; None if it is cut off everywhere."""
    at = np.flatnonzero((values > 2.0) & (values < 250.0))
    if len(at) < 8:
        return None
    slope, start = np.polyfit(at, values[at], 1)
    return float(slope), float(start)


class ImperfectNetwork:
    """Takes the place of `fairlead.detect.onnx.Network`."""

    def __init__(self, names: tuple[str, ...], X_true: Points3, camera: Camera, rng: np.random.Generator) -> None:
        network_input = NetworkInput(name="image", width=256, height=256, any_size=True)
        self.card = NetworkCard(name="imperfect", landmarks=names, input=network_input)
        self.size = (256, 256)
        self.T_camera_target: Matrix4 | None = None
        """Of the image that is looked at; None: there is no target in it."""
        self.looks = 0.0
        """In units of a crop."""
        self._X, self._camera, self._rng = X_true, camera, rng
        self._hidden = rng.random(len(names)) < 0.15

    def look(self, crop: Image) -> Keypoints:
        """Keypoints of a crop of a `ramps` image."""
        height, width = crop.shape[:2]
        self.looks += height * width / 256**2
        n, rng = len(self._X), self._rng
        anywhere = rng.uniform(0.0, 1.0, (n, 2)) * [width, height]
        nothing = Keypoints(
            pixels=anywhere, covariances=np.tile(9.0 * np.eye(2), (n, 1, 1)), scores=rng.normal(-3.0, 1.5, n)
        )
        across, down = ramp(crop[..., 2].mean(axis=0)), ramp(crop[..., 1].mean(axis=1))
        if self.T_camera_target is None or across is None or down is None:
            return nothing
        pixels = geometry.project(self._camera, geometry.transform(self.T_camera_target, self._X))
        levels = (pixels - 1.5) * LEVELS_PER_PX
        z = np.column_stack([(levels[:, i] - start) / slope for i, (slope, start) in enumerate((across, down))])
        ratio = float(np.ptp(z, axis=0).max()) / TRAINED_PX
        badness = float(np.clip(abs(np.log(ratio)) - 0.5, 0.0, 1.0))  # 0 from 0.6 to 1.65, 1 below 0.22
        inside = np.all((z > -0.5) & (z < np.array([width, height]) - 0.5), axis=1) & ~self._hidden
        found = inside & (rng.random(n) < 0.97 - 0.9 * badness)
        sigma = 1.5 * (1.0 + 4.0 * badness) * max(ratio, 0.3) ** 0.5
        heavy = np.sqrt(4.0 / rng.chisquare(4.0, n))[:, None]
        return Keypoints(
            pixels=np.where(found[:, None], z + sigma * heavy * rng.standard_normal((n, 2)), anywhere),
            covariances=np.tile(sigma**2 * np.eye(2), (n, 1, 1)),
            scores=np.where(found, rng.normal(3.0 - 4.0 * badness, 1.0, n), nothing.scores),
        )
