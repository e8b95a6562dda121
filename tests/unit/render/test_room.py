# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Crops of small things in rooms: how they are held, what hides them, the light on them."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fairlead.cli import main
from fairlead.render.command import envelope_of
from fairlead.render.crop_view import draw_view
from fairlead.render.errors import RenderError
from fairlead.types import Target
from tests.unit.render.conftest import Shipped, pinhole


def test_up_is_up_and_reach_is_near() -> None:
    """A pen of 50 mm that is held by its end at -y."""
    X = np.array([[0.0, -0.04, 0.0], [0.0, 0.01, 0.0]])
    target = Target(name="pen", landmarks=("a", "b"), positions=X, covariance=np.zeros((6, 6)))
    envelope, rng = envelope_of(target, "room", (0.0, -2.0, 0.0)), np.random.default_rng(0)
    views = [draw_view(X, pinhole(1024, 1910.0), envelope, 64, rng) for _ in range(200)]
    up = np.array([view.T_camera_target[:3, :3] @ [0.0, -1.0, 0.0] for view in views])
    assert np.mean(up[:, 1] < -0.3) > 0.95  # the camera's y is down
    assert np.ptp(np.arctan2(up[:, 0], -up[:, 1])) > 0.5
    ranges = [np.linalg.norm(view.T_camera_target[:3, 3]) for view in views]
    assert 2.0 * 0.05 < min(ranges) < max(ranges) < 13.0 * 0.05
    with pytest.raises(RenderError, match="--up"):
        envelope_of(target, "room", (0.0, 0.0, 0.0))


@pytest.mark.parametrize("up", [(0.0, 0.0, 1.0), (0.0, 0.0, -3.0), (0.0, -1.0, 0.0), (1.0, 2.0, 3.0)])
def test_up_becomes_z(up: tuple[float, float, float]) -> None:
    target = Target(name="p", landmarks=("a", "b"), positions=np.eye(3)[:2], covariance=np.zeros((6, 6)))
    R = envelope_of(target, "room", up).R_level_target
    assert np.allclose(R @ up, [0.0, 0.0, np.linalg.norm(up)])
    assert np.allclose(R @ R.T, np.eye(3))
    assert np.linalg.det(R) == pytest.approx(1.0)


def test_what_stands_before_the_target_hides_it(
    graphics: None, shipped: Callable[[str], Shipped], tmp_path: Path
) -> None:
    """A ball about the whole pen, and nothing at all."""
    from fairlead.render.clutter import thing
    from fairlead.render.crops import CropJob, CropMaker
    from fairlead.render.modelling import Modeller
    from fairlead.render.raster.vertices import pack

    target = shipped("marker_pen").target
    envelope = envelope_of(target, "room", (0.0, -1.0, 0.0))
    job = CropJob(
        target=target, camera=pinhole(1024, 1910.0), folder=tmp_path, count=6, envelope=envelope, size=64,
        surroundings="room",
    )  # fmt: skip
    (tmp_path / "images").mkdir()
    maker = CropMaker(job)
    modeller = Modeller(thing(np.random.default_rng(0)).materials)
    modeller.ball("a", (0.0, 0.0, 0.0), 1.0)
    unit = modeller.surface()
    ball = maker._renderer.add(pack(unit.with_vertices(0.08 * unit.vertices)))
    counts = []
    for others in ([], [(ball, np.eye(4))]):
        maker._stage.others = lambda T, rng, others=others: [(model, T @ pose) for model, pose in others]
        labels = maker.make(0)
        counts.append([sum(v == 2 for v in label["keypoints"][2::3]) for label in labels])
    assert min(counts[0]) >= 4
    assert max(counts[1]) == 0


def test_light_comes_from_the_room() -> None:
    """The meter reads what the panorama sheds: pi times its radiance if that is the same everywhere."""
    from dataclasses import replace

    from fairlead.render.room import in_a_room

    room = in_a_room(np.random.default_rng(1))
    assert room.backdrop is not None
    assert np.isfinite(room.backdrop).all()
    assert room.backdrop.min() >= 0.0
    even = replace(
        room, backdrop=np.full((64, 256, 3), 0.5, np.float32), sky=replace(room.sky, sun_irradiance=np.zeros(3))
    )
    assert even.metered == pytest.approx(0.5 * np.pi)
    assert np.allclose(even.from_below, 0.5)
    assert room.air_per_m == 0.0


def test_there_are_no_flights_through_rooms(
    repository: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    target = str(repository / "data" / "frigate" / "target.toml")
    for what in (["landing"], ["crops", "--quality", "full"]):
        assert main(["render", *what, "--target", target, "--surroundings", "room", "-o", str(tmp_path)]) == 2
        assert capsys.readouterr().err.count("\n") == 1
