# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from fairlead.simulate import ModelError, ObservationError


def test_told_covariance_by_hand():
    """Two landmarks 2 m apart along x, sigma 0.1, scale 0.5: x0 = (-1, 0, 0, 1, 0, 0)."""
    X0 = np.array([[4.0, 1.0, 0.0], [6.0, 1.0, 0.0]])
    P0 = ModelError(sigma_m=0.1, scale_sigma=0.5).told_covariance(X0)
    expected = 0.01 * np.eye(6)
    expected[np.ix_([0, 3], [0, 3])] += 0.25 * np.array([[1, -1], [-1, 1]])
    np.testing.assert_allclose(P0, expected)
    np.testing.assert_allclose(ModelError(sigma_m=0.1, scale_sigma=0.5, told_factor=3.0).told_covariance(X0), 9 * P0)


def test_draws_have_the_told_covariance():
    """Mean Mahalanobis square of 4,000 draws is 3n = 12 within 4 standard errors, sqrt(2 * 12 / 4000) each."""
    X0 = np.array([[0.0, 0, 0], [9, 1, 0], [3, 7, 2], [5, 5, 8]])
    error, rng = ModelError(sigma_m=0.3, scale_sigma=0.1), np.random.default_rng(1)
    information = np.linalg.inv(error.told_covariance(X0))
    offsets = np.array([(error.draw(X0, rng) - X0).ravel() for _ in range(4000)])
    mean = np.einsum("ri,ij,rj->r", offsets, information, offsets).mean()
    assert mean == pytest.approx(12.0, abs=4 * np.sqrt(24 / 4000))


def test_noise_and_outliers():
    """30 % of 20,000 observations lie 30 px off within the noise, the others have the told sigma: 4 standard errors."""
    true = np.zeros((20_000, 2))
    seen = ObservationError(sigma_px=0.5, outlier_fraction=0.3).draw(true, np.random.default_rng(2))
    distance = np.linalg.norm(seen, axis=1)
    wrong = distance > 15.0
    assert wrong.mean() == pytest.approx(0.3, abs=4 * np.sqrt(0.3 * 0.7 / 20_000))
    assert np.abs(distance[wrong] - 30.0).max() < 3.0
    assert seen[~wrong].std() == pytest.approx(0.5, rel=4 / np.sqrt(2 * 28_000))
    assert np.linalg.norm(seen[wrong].mean(axis=0)) < 4 * 30 / np.sqrt(6000)


def test_outliers_come_on_top_of_the_same_noise():
    true = np.zeros((100, 2))
    clean = ObservationError(sigma_px=1.0).draw(true, np.random.default_rng(3))
    dirty = ObservationError(sigma_px=1.0, outlier_fraction=0.1).draw(true, np.random.default_rng(3))
    changed = np.any(clean != dirty, axis=1)
    assert 0 < changed.sum() < 30
    np.testing.assert_allclose(np.linalg.norm((dirty - clean)[changed], axis=1), 30.0)


@pytest.mark.parametrize(
    "make",
    [
        lambda: ModelError(sigma_m=-1.0),
        lambda: ModelError(told_factor=0.0),
        lambda: ObservationError(sigma_px=0.0),
        lambda: ObservationError(outlier_fraction=1.5),
        lambda: ObservationError(sigma_px=float("nan")),
    ],
)
def test_impossible_errors_are_refused(make):
    with pytest.raises(ValueError, match="expected"):
        make()
