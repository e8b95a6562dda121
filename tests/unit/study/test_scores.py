# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Numbers that can be worked out by hand."""

import numpy as np
import pytest

from fairlead.study.block import finish, prepare
from fairlead.study.scores import mean_length, normalised_squares
from fairlead.study.settings import Setting
from fairlead.study.summary import Comparison, compare, crossing, describe


@pytest.mark.parametrize(
    ("variances", "expected"),
    [
        ((4.0, 0.0, 0.0), 2.0 * np.sqrt(2.0 / np.pi)),  # half-normal
        ((4.0, 4.0, 0.0), 2.0 * np.sqrt(np.pi / 2.0)),  # Rayleigh
        ((4.0, 4.0, 4.0), 2.0 * np.sqrt(8.0 / np.pi)),  # Maxwell
        ((0.0, 0.0, 0.0), 0.0),
    ],
)
def test_mean_length_of_known_distributions(variances, expected):
    """docs/study.md eq. (1); the quadrature is good to 1e-5 where a direction is missing."""
    assert mean_length(np.diag(variances)[None])[0] == pytest.approx(expected, rel=1e-4)


def test_mean_length_of_any_covariance():
    """Against 10^6 draws: their standard error is 0.1 % or less."""
    A = np.array([[3.0, 0.0, 0.0], [1.0, 0.5, 0.0], [-2.0, 0.1, 0.02]])
    draws = np.random.default_rng(0).standard_normal((1_000_000, 3)) @ A.T
    assert mean_length((A @ A.T)[None])[0] == pytest.approx(np.linalg.norm(draws, axis=1).mean(), rel=4e-3)


def test_squares_with_mixed_units():
    P = np.diag([1e6, 1e-8])[None]
    assert normalised_squares(np.array([[2e3, 3e-4]]), P)[0] == pytest.approx(13.0)
    assert np.isnan(normalised_squares(np.ones((1, 2)), np.zeros((1, 2, 2)))[0])


def test_describe_leaves_out_what_is_missing():
    statistic = describe(np.array([1.0, np.nan, 3.0, 8.0]))
    assert (statistic.mean, statistic.median, statistic.runs) == (4.0, 3.0, 3)
    assert 1.0 <= statistic.low < 4.0 < statistic.high <= 8.0


def test_the_interval_holds_the_mean_as_often_as_it_says():
    """95 % of 400 means of 50 draws: 380, and 3.5 standard errors of a binomial, 15; the bootstrap loses 1 or 2 %."""
    rng = np.random.default_rng(1)
    inside = sum(s.low <= 1.0 <= s.high for s in (describe(rng.exponential(size=50)) for _ in range(400)))
    assert 350 <= inside <= 395


def test_pairs_of_runs_are_compared_together():
    theirs = np.array([1.0, 2.0, 30.0, np.nan])
    assert compare(0.5 * theirs, theirs) == Comparison(ratio=0.5, low=0.5, high=0.5)


@pytest.mark.parametrize(
    ("ratios", "expected"),
    [
        ([0.5, 0.5, 1.5], np.sqrt(2.0 * 8.0)),
        ([0.5, 0.9, 0.9], None),
        ([1.1, 1.2, 1.3], None),
        ([1.5, 0.5, 1.5], 4.0),
        ([1.5, 0.5, 0.5], 1.0),
    ],
)
def test_the_crossing_lies_between_the_settings(ratios, expected):
    found = crossing([0.5, 2.0, 8.0], ratios)
    assert found is None if expected is None else found == pytest.approx(expected)


def test_nothing_is_made_up(task):
    """Methods that say nothing of the model have no error of it; the bound has no failures and no NEES."""
    columns = finish(task, prepare(task, Setting(views=3), (0,)), threads=1).columns
    assert np.isnan(columns["true-model"]["landmark_m"]).all()
    assert np.isnan(columns["bound"]["pose_nees"]).all()
    assert columns["map"]["failed"][0] == 0.0
    assert 0.0 < columns["bound"]["translation_m"][0] <= columns["bound"]["translation_rms_m"][0]
