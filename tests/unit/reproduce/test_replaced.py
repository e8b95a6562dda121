# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Errors of a network replaced by others: each kind has the one property that it is named for."""

from dataclasses import replace

import numpy as np
import pytest

from fairlead.reproduce.measured import Measured, Observed, measure
from fairlead.reproduce.methods import Flight
from fairlead.reproduce.replaced import KINDS, replaced

FRAMES = 500
BY_NAME = {kind.name: kind for kind in KINDS}


@pytest.fixture(scope="module")
def noisy(flight: Flight) -> tuple[Flight, Measured]:
    """Errors that stay for 2 s, are constant in part, wild now and then, and twice as large as told in x."""
    rng = np.random.default_rng(7)
    n = len(flight.X_true)
    keep = np.exp(-0.5 / 2.0)
    e = rng.standard_normal((FRAMES, n, 2))
    for k in range(1, FRAMES):
        e[k] = keep * e[k - 1] + np.sqrt(1.0 - keep**2) * e[k]
    e += 0.5 * rng.standard_normal((n, 2))
    e[rng.random((FRAMES, n)) < 0.02] *= 12.0
    e[:, 3] = np.nan
    S = np.tile(np.diag([4.0, 1.0]), (FRAMES, n, 1, 1))
    S[:, 3] = np.nan
    errors = e * np.array([2.0, 1.0])
    observed = Observed(
        stamps_ns=500_000_000 * np.arange(FRAMES),
        pixels=300.0 + errors,
        covariances=S,
        errors=errors,
        visible=np.ones((FRAMES, n), dtype=bool),
    )
    measured = measure(observed)
    assert measured is not None
    return replace(flight, observed=observed), measured


def made(noisy: tuple[Flight, Measured], name: str) -> tuple[Flight, Measured]:
    flight = replaced(noisy[0], BY_NAME[name], noisy[1], seed=4)
    measured = measure(flight.observed)
    assert measured is not None
    return flight, measured


def test_truth_and_told_covariances_stay(noisy):
    for name in BY_NAME:
        flight, _ = made(noisy, name)
        true = flight.observed.pixels - flight.observed.errors
        np.testing.assert_allclose(true[np.isfinite(true)], 300.0, atol=1e-9)
        np.testing.assert_array_equal(flight.observed.covariances, noisy[0].observed.covariances)
        assert np.isnan(flight.observed.errors[:, 3]).all()
        view = flight.views[5]
        at = [flight.told.landmarks.index(each) for each in view.landmarks]
        np.testing.assert_array_equal(view.pixels, flight.observed.pixels[5, at])


def test_drawn_errors_are_as_large_as_measured_and_new(noisy):
    _, found = made(noisy, "white")
    assert found.factor == pytest.approx(noisy[1].factor, rel=0.03)
    assert found.inefficiency == 1.0
    assert found.outliers < 0.003


def test_dealt_errors_keep_their_tails_and_nothing_else(noisy):
    flight, found = made(noisy, "dealt")
    assert found.outliers == pytest.approx(noisy[1].outliers, rel=0.01)
    assert found.inefficiency < 1.2
    before, after = (np.sort(each.observed.errors[..., 0], axis=None) for each in (noisy[0], flight))
    np.testing.assert_allclose(after, before, rtol=1e-9)


def test_staying_errors_stay_as_long(noisy):
    _, found = made(noisy, "staying")
    assert found.stays_s == pytest.approx(noisy[1].stays_s, rel=0.35)
    assert found.factor == pytest.approx(noisy[1].factor, rel=0.1)
    assert found.outliers < 0.003


def test_random_signs_keep_sizes_and_series(noisy):
    flight, found = made(noisy, "signed")
    before, after = noisy[0].observed.errors, flight.observed.errors
    np.testing.assert_allclose(np.abs(after), np.abs(before), rtol=1e-9)
    flipped = np.delete(after / before, 3, axis=1)
    np.testing.assert_allclose(flipped, np.broadcast_to(flipped[:1], flipped.shape), rtol=1e-6)
    assert 0.2 < (flipped[0] < 0.0).mean() < 0.8
    assert found.stays_s == pytest.approx(noisy[1].stays_s)


def test_centred_errors_have_no_mean_and_inlying_ones_no_outliers(noisy):
    centred, _ = made(noisy, "centred")
    assert np.abs(np.nanmean(np.delete(centred.observed.errors, 3, axis=1), axis=0)).max() < 1e-9
    inlying, found = made(noisy, "inlying")
    assert noisy[1].outliers > 0.005
    assert found.outliers <= 0.1 * noisy[1].outliers
    kept = np.isfinite(inlying.observed.errors)
    np.testing.assert_allclose(inlying.observed.errors[kept], noisy[0].observed.errors[kept])


def test_the_networks_own_errors_are_untouched(noisy):
    flight, _ = made(noisy, "real")
    np.testing.assert_allclose(flight.observed.pixels, noisy[0].observed.pixels)


def test_the_same_seed_draws_the_same(noisy):
    first, second = (replaced(noisy[0], BY_NAME["staying"], noisy[1], seed=s).observed.pixels for s in (1, 1))
    np.testing.assert_array_equal(first, second)
    other = replaced(noisy[0], BY_NAME["staying"], noisy[1], seed=2).observed.pixels
    assert not np.array_equal(np.nan_to_num(first), np.nan_to_num(other))
