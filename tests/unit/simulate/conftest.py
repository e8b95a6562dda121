# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
import pytest

from fairlead.io.camera import load_camera
from fairlead.io.target import load_target
from fairlead.simulate import Arc, Frames, ModelError, Scenario


@pytest.fixture(scope="session")
def ship(repository):
    """(target, camera)."""
    folder = repository / "data" / "frigate"
    return load_target(folder / "target.toml"), load_camera(folder / "camera.yaml")


@pytest.fixture(scope="session")
def plain(ship):
    """A quarter circle in 10 s, five images a second, nothing but white noise and a rough model."""
    target, camera = ship
    path, frames = Arc(duration_s=10.0), Frames(rate_hz=5.0)
    return Scenario(name="plain", target=target, camera=camera, trajectory=path, frames=frames, model=ModelError())
