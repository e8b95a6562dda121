# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Are the flights those of `simulate_arc`, and is a run the same wherever it is drawn?"""

from dataclasses import replace

import numpy as np
import pytest

from fairlead.baselines.epnp import EpnpTracker
from fairlead.opencv import epnp_views
from fairlead.simulate import simulate_arc
from fairlead.study.flights import draw_flights, first_poses
from fairlead.study.settings import Setting, find_setting, settings_of

SETTING = Setting(sigma_px=2.0, outlier_fraction=0.1, views=4)


def test_flights_are_those_of_the_simulation(task):
    block = draw_flights(task.target, task.camera, SETTING, (0, 5), task.seed)
    for i, run in enumerate(block.runs):
        rng = SETTING.generator(task.seed, run)
        flight = simulate_arc(task.target, task.camera, SETTING.scenario, rng)
        np.testing.assert_array_equal(block.X0[i], flight.target_told.positions)
        np.testing.assert_array_equal(block.P0[i], flight.target_told.covariance)
        np.testing.assert_array_equal(block.pixels[i], [view.pixels for view in flight.views])
        np.testing.assert_array_equal(block.T_true, flight.T_true)
        np.testing.assert_array_equal(block.stamps_ns, [view.stamp_ns for view in flight.views])


def test_a_run_is_the_same_alone_and_among_others(task):
    many = draw_flights(task.target, task.camera, SETTING, range(6), task.seed)
    one = draw_flights(task.target, task.camera, SETTING, (4,), task.seed)
    np.testing.assert_array_equal(one.pixels[0], many.pixels[4])


@pytest.mark.parametrize("other", [replace(SETTING, sigma_px=1.0), replace(SETTING, angle_deg=30.0)])
def test_settings_share_no_randomness(task, other):
    here, there = SETTING.generator(task.seed, 0), other.generator(task.seed, 0)
    assert here.standard_normal() != there.standard_normal()
    assert SETTING.generator(task.seed, 0).standard_normal() != SETTING.generator(task.seed + 1, 0).standard_normal()


def test_the_starts_are_those_of_epnp(task):
    """The same solver on the same numbers; the translation is moved from the centroid in another order of rounding."""
    block = draw_flights(task.target, task.camera, SETTING, (0,), task.seed)
    flight = simulate_arc(task.target, task.camera, SETTING.scenario, SETTING.generator(task.seed, 0))
    tracker = EpnpTracker(flight.target_told, task.camera)
    expected = np.stack([tracker.update(view).T_camera_target for view in flight.views])
    np.testing.assert_allclose(first_poses(block)[0], expected, rtol=1e-9, atol=1e-9)


def test_a_view_without_an_answer_is_none(task):
    block = draw_flights(task.target, task.camera, SETTING, (0,), task.seed)
    pixels = block.pixels[0].copy()
    pixels[1, 4, 0] = np.nan
    pixels[2] = pixels[2].mean(axis=0)
    missing = np.isnan(epnp_views(block.X0[0], pixels, task.camera)).all(axis=(1, 2))
    assert missing.tolist() == [False, True, True, False]


def test_a_wrong_number_of_points_is_refused(task):
    with pytest.raises(ValueError, match="EPnP: expected"):
        epnp_views(task.target.positions[:3], np.zeros((1, 3, 2)), task.camera)


def test_a_flat_target_gets_poses_too(task):
    flat = replace(task.target, positions=task.target.positions * np.array([1.0, 1.0, 0.0]))
    setting = Setting(sigma_px=0.25, model_sigma_m=0.01, views=3)
    block = draw_flights(flat, task.camera, setting, (0,), task.seed)
    assert np.isfinite(first_poses(block)).all()


@pytest.mark.parametrize("kind", ["noise", "angle", "grid"])
def test_every_setting_has_a_name_of_its_own(kind):
    settings = settings_of(kind)
    assert len({setting.name for setting in settings}) == len(settings)
    assert find_setting(settings, settings[-1].name) == settings[-1]


def test_names_say_the_values():
    assert (
        Setting(sigma_px=0.25, angle_deg=30.0, model_sigma_m=3.0, outlier_fraction=0.1).name == "s0.25-a30-m3-o0.1-v10"
    )


def test_an_unknown_name_is_refused():
    with pytest.raises(ValueError, match="such as s0"):
        find_setting(settings_of("noise"), "s7")
