# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Shipped targets with their surfaces; what needs embreex or EGL skips where there is none."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from fairlead.io.target import load_target
from fairlead.render.errors import RenderError
from fairlead.render.raycast import RayCaster
from fairlead.render.surface import Surface
from fairlead.render.surface_file import load_surface
from fairlead.types import Camera, Target


@dataclass(frozen=True, kw_only=True, eq=False)
class Shipped:
    """A target of data/ and its mesh."""

    target: Target
    surface: Surface
    caster: RayCaster


@pytest.fixture(scope="session")
def shipped(repository: Path) -> Callable[[str], Shipped]:
    """The target of data/NAME."""
    pytest.importorskip("embreex", reason="embreex is not installed (fairlead[render])")
    kept: dict[str, Shipped] = {}

    def load(name: str) -> Shipped:
        if name not in kept:
            target = load_target(repository / "data" / name / "target.toml")
            assert target.mesh is not None
            surface = load_surface(target.mesh)
            kept[name] = Shipped(target=target, surface=surface, caster=RayCaster(surface))
        return kept[name]

    return load


@pytest.fixture(scope="session")
def frigate(shipped: Callable[[str], Shipped]) -> Shipped:
    return shipped("frigate")


@pytest.fixture(scope="session")
def camera() -> Camera:
    """The published camera."""
    return pinhole(1024, 1910.0)


def pinhole(size: int, focal_px: float) -> Camera:
    """A square pinhole camera, principal point in the middle."""
    middle = 0.5 * (size - 1)
    K = np.array([[focal_px, 0.0, middle], [0.0, focal_px, middle], [0.0, 0.0, 1.0]])
    return Camera(name="test", width=size, height=size, model="pinhole", K=K, distortion=np.zeros(0))


@pytest.fixture(scope="session")
def graphics() -> None:
    """Skips, with the reason, where no image can be drawn."""
    pytest.importorskip("moderngl", reason="moderngl is not installed (fairlead[render])")
    from fairlead.render.raster.context import open_context

    try:
        open_context()
    except RenderError as error:
        pytest.skip(str(error))
