# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Weather is rendered where it is missing, and only there."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from fairlead.progress import silent
from fairlead.reproduce import skies
from fairlead.reproduce.experiments.weather import calibrated


@pytest.fixture
def rendered(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, object, object]]:
    """What the renderer was asked for; it writes the two files that say that a folder is done."""
    asked: list[tuple[str, object, object]] = []

    def render(flight: str, folder: Path, **told: object) -> int:
        del flight
        asked.append((folder.name, told["weather"], told["strength"]))
        folder.mkdir(parents=True)
        for name in ("truth.csv", "scene_gt.json"):
            (folder / name).touch()
        return 1

    monkeypatch.setattr(skies, "render", render)
    return asked


def test_every_kind_and_strength_is_rendered_once(rendered, tmp_path):
    skies.render_skies(tmp_path, silent)
    assert len(rendered) == 1 + len(skies.KINDS) * len(skies.STRENGTHS)
    assert rendered[0] == ("clear-0", None, 0.0)
    assert ("fog-0.4", "fog", 0.4) in rendered
    skies.render_skies(tmp_path, silent)
    assert len(rendered) == len({name for name, _, _ in rendered})


def test_what_was_cut_short_is_made_again(rendered, tmp_path):
    skies.render_skies(tmp_path, silent)
    shutil.rmtree(tmp_path / "rain-0.7")
    rendered.clear()
    skies.render_skies(tmp_path, silent)
    assert rendered == [("rain-0.7", "rain", 0.7)]


def test_nothing_is_rendered_into_somebody_elses_folder(rendered, tmp_path):
    (tmp_path / "hail-1").mkdir()
    (tmp_path / "hail-1" / "truth.csv").touch()
    skies.render_skies(tmp_path, silent)
    assert rendered == []


def test_calibrated_views_tell_the_scaled_covariance(flight):
    found = calibrated(flight, 3.0)
    for view, before in zip(found.views, flight.views, strict=True):
        np.testing.assert_allclose(view.covariances, 3.0 * before.covariances)
        np.testing.assert_array_equal(view.pixels, before.pixels)
