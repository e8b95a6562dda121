# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A satellite seen from many sides, with clicks of known noise."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from fairlead.annotate.labels import Labels, Landmark, Mark, triple
from fairlead.annotate.suggest import even_directions
from fairlead.annotate.surface import Surface, load_surface
from fairlead.cameras import project
from fairlead.geometry import inverse, transform
from fairlead.io.camera import load_camera
from fairlead.io.target import load_target
from fairlead.types import Camera, Matrix4, Target


def looking_at_origin(centre: np.ndarray) -> Matrix4:
    """T_camera_target of a camera at `centre` that looks at the target's origin, z of the target up."""
    z = -centre / np.linalg.norm(centre)
    x = np.cross(z, [0.0, 0.0, 1.0])
    x /= np.linalg.norm(x)
    T = np.eye(4)
    T[:3, :3] = np.stack([x, np.cross(z, x), z])
    T[:3, 3] = -T[:3, :3] @ centre
    return T


@dataclass(frozen=True, kw_only=True)
class Scene:
    """The satellite and where it is looked at from."""

    target: Target
    camera: Camera
    surface: Surface
    T_camera_target: np.ndarray

    def seen(self) -> np.ndarray:
        """(k, n): which landmarks nothing hides."""
        eyes = [inverse(T)[:3, 3] for T in self.T_camera_target]
        return np.array([self.surface.seen_from(eye, self.target.positions) for eye in eyes])

    def pixels(self) -> np.ndarray:
        """(k, n, 2) [px]."""
        return np.array([project(self.camera, transform(T, self.target.positions)) for T in self.T_camera_target])

    def labels(self, rng: np.random.Generator, sigma_m: float = 0.0, noise_px: float = 1.0) -> Labels:
        """Landmarks that are `sigma_m` off, each click `noise_px` off."""
        told = self.target.positions + sigma_m * rng.standard_normal(self.target.positions.shape)
        landmarks = tuple(
            Landmark(number=i, name=name, position_m=triple(told[i]), sigma_m=(sigma_m, sigma_m, sigma_m))
            for i, name in enumerate(self.target.landmarks)
        )
        pixels = self.pixels()
        clicked = pixels + noise_px * rng.standard_normal(pixels.shape)
        frames = {
            k: {int(i): Mark(u_px=float(clicked[k, i, 0]), v_px=float(clicked[k, i, 1])) for i in np.flatnonzero(seen)}
            for k, seen in enumerate(self.seen())
        }
        return Labels(landmarks=landmarks, frames=frames)


@pytest.fixture(scope="session")
def scene(repository: Path) -> Scene:
    folder = repository / "data" / "satellite"
    centres = 35.0 * even_directions(40)[10:30]
    return Scene(
        target=load_target(folder / "target.toml"),
        camera=load_camera(folder / "camera.yaml"),
        surface=load_surface(folder / "satellite.ply"),
        T_camera_target=np.array([looking_at_origin(centre) for centre in centres]),
    )
