# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The demo: a rough drawing and real photographs in, a better model out, judged on photographs that it has not seen."""

import numpy as np
import pytest

from fairlead.cli import main
from fairlead.config import DemoConfig
from fairlead.demo import SHOWN, PenResult, ShipResult, demo_pen, demo_ship, tag_side
from fairlead.demo.show import show_ship
from fairlead.io.run_record import read_run_record
from fairlead.io.shipped import shipped_data
from fairlead.io.target import load_target
from fairlead.types import Target


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> PenResult:
    return demo_pen(DemoConfig(recording="pen", output=tmp_path_factory.mktemp("demo")))


def test_the_refined_model_is_better_also_on_photographs_that_it_has_not_seen(result: PenResult) -> None:
    assert result.photographs == 16
    assert result.corners >= 200
    assert result.refined_px <= 0.42
    assert result.refined_unseen_px <= 0.70
    assert result.drawing_px > 1.0
    assert result.drawing_unseen_px > 1.0
    for name in ("refine", "map", "epnp"):
        assert read_run_record(result.report.parent / name / "run.json").state == "done"
        assert name in result.report.read_text()


def test_the_demo_prints_its_table(
    result: PenResult, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fairlead.demo.show.demo_pen", lambda config: result)
    assert main(["demo", "pen"]) == 0
    output = capsys.readouterr()
    for word in ("reprojection [px rms]", "mean side of the tags [mm]", "13.00", str(result.report)):
        assert word in output.out
    assert output.err == ""


@pytest.fixture(scope="module")
def ship(tmp_path_factory: pytest.TempPathFactory) -> ShipResult:
    return demo_ship(DemoConfig(output=tmp_path_factory.mktemp("ship")))


def test_the_ship_is_tracked_from_pixels_to_poses(ship: ShipResult) -> None:
    assert ship.frames == 200
    assert read_run_record(ship.report.parent / "fairlead" / "run.json").frames_with_pose >= 195
    ours, alone = ship.metrics["fairlead"], ship.metrics["epnp"]
    assert ours["rotation_deg"] < alone["rotation_deg"]
    assert ours["translation_m"] < alone["translation_m"]
    assert ours["landmarks_m"] < ship.landmarks_told_m
    assert ours["pose_nees"] < 3.0
    assert ship.overlay.stat().st_size > 1_000_000


def test_the_demo_shows_the_ship_beside_epnp(ship: ShipResult, capsys: pytest.CaptureFixture[str]) -> None:
    show_ship(ship)
    output = capsys.readouterr().out
    for _, label in SHOWN:
        assert label in output
    assert str(ship.overlay) in output


def test_side_of_tags_and_its_sigma_by_hand() -> None:
    # one tag of 10 mm; only tr moves, 1 mm along x: the top side gets 1 mm longer, the right side stays to first order
    corners = np.array([[0.0, 0.0, 0.0], [0.01, 0.0, 0.0], [0.01, 0.01, 0.0], [0.0, 0.01, 0.0]])
    covariance = np.zeros((12, 12))
    covariance[3, 3] = 1e-6
    names = ("tag1_tl", "tag1_tr", "tag1_br", "tag1_bl")
    side = tag_side(Target(name="t", landmarks=names, positions=corners, covariance=covariance))
    assert np.isclose(side.mean_mm, 10.0)
    assert np.isclose(side.sigma_mm, 0.25)
    covariance[0, 0] = covariance[0, 3] = covariance[3, 0] = 1e-6  # tl moves along with tr: no side changes
    side = tag_side(Target(name="t", landmarks=names, positions=corners, covariance=covariance))
    assert side.sigma_mm < 1e-9


def test_the_drawing_comes_with_the_program() -> None:
    assert load_target(shipped_data("marker_pen") / "target.toml").name == "marker_pen"
    with pytest.raises(FileNotFoundError, match="did not come with this installation"):
        shipped_data("nothing")
