# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What is measured of a detector, on errors that are known."""

from dataclasses import replace

import numpy as np
import pytest

from fairlead.reproduce.bounds import bound, causal_bound
from fairlead.reproduce.measured import Observed, correlation_time_s, measure, observe
from reference.bound import bayesian_bound


def drawn(k: int = 400, n: int = 20, told: float = 1.0, constant: float = 0.0) -> Observed:
    rng = np.random.default_rng(2)
    errors = rng.standard_normal((k, n, 2)) + constant * rng.standard_normal((n, 2))
    return Observed(
        stamps_ns=np.arange(k),
        pixels=errors + 100.0,
        covariances=np.tile(told * np.eye(2), (k, n, 1, 1)),
        errors=errors,
        visible=np.ones((k, n), dtype=bool),
    )


def test_white_errors_of_the_told_size():
    found = measure(drawn())
    assert found is not None
    assert found.mean_px == pytest.approx(np.sqrt(np.pi / 2), rel=0.02)
    assert found.factor == pytest.approx(1.0, abs=0.05)
    assert found.inside_90 == pytest.approx(0.9, abs=0.01)
    assert found.outliers == pytest.approx(0.001, abs=0.001)
    assert found.inefficiency == 1.0
    assert found.bias_px < 0.1


def test_a_covariance_that_is_four_times_too_small():
    found = measure(drawn(told=0.25))
    assert found is not None
    assert found.factor == pytest.approx(4.0, abs=0.2)
    assert found.inside_50 == pytest.approx(1.0 - 0.5**0.25, abs=0.01)


def test_errors_that_stay():
    found = measure(drawn(constant=2.0))
    assert found is not None
    assert found.bias_px == pytest.approx(2.0 * np.sqrt(2.0), rel=0.3)
    assert found.inefficiency > 50.0


def test_errors_that_stay_for_a_time():
    rng = np.random.default_rng(3)
    observed = drawn(k=2000)
    keep = np.exp(-0.2 / 1.5)
    errors = np.empty_like(observed.errors)
    errors[0] = rng.standard_normal(errors.shape[1:])
    for k in range(1, len(errors)):
        errors[k] = keep * errors[k - 1] + np.sqrt(1.0 - keep**2) * rng.standard_normal(errors.shape[1:])
    series = replace(observed, errors=errors, stamps_ns=200_000_000 * np.arange(2000))
    found = measure(series)
    assert found is not None
    assert found.inefficiency == pytest.approx((1 + keep) / (1 - keep), rel=0.15)
    assert correlation_time_s(series, found.inefficiency) == pytest.approx(1.5, rel=0.15)
    assert correlation_time_s(series, 1.0) == 0.0


def test_what_is_hidden_or_missing_is_counted_apart():
    observed = drawn(k=10)
    hidden = observed.visible.copy()
    hidden[:, :5] = False
    gone = observed.errors.copy()
    gone[:, 10:15] = np.nan
    found = measure(replace(observed, visible=hidden, errors=gone))
    assert found is not None
    assert found.found == pytest.approx(10 / 15)
    assert np.isfinite(found.hidden_px)
    assert measure(replace(observed, errors=np.full_like(gone, np.nan))) is None


def test_views_are_put_beside_the_truth(sequence):
    from fairlead.io.observations import read_views

    views = list(read_views(sequence.folder / "detections" / "heat-t.csv"))
    views = [replace(view, frame=k, stamp_ns=view.stamp_ns + 400_000) for k, view in enumerate(views)]
    observed = observe(sequence, views[1:])
    assert np.isnan(observed.errors[0]).all()
    assert np.abs(observed.errors[1:]).max() < 5.0 * 0.7
    assert measure(observed).factor == pytest.approx(1.0, abs=0.25)


def test_the_bound_is_the_oracles(flight):
    found = bound(flight, factor=2.0)
    oracle = bayesian_bound(
        lambda p: p[..., :2] / p[..., 2:] * np.diag(flight.camera.K)[:2] + flight.camera.K[:2, 2],
        flight.X_true,
        flight.told.covariance,
        flight.T_true,
        2.0 * flight.observed.covariances,
    )
    assert found.X_covariance == pytest.approx(oracle.landmark_covariance, rel=1e-5, abs=1e-7)
    np.testing.assert_allclose(found.translation_rms_m, np.sqrt(oracle.translation_variances), rtol=1e-5)


def test_errors_that_stay_weigh_on_what_views_say_together(flight):
    white, alike = bound(flight), bound(flight, inefficiency=6.0)
    assert alike.model_rms_m > 1.05 * white.model_rms_m
    assert (alike.translation_rms_m > white.translation_rms_m).all()
    exact = replace(flight, told=replace(flight.told, covariance=np.zeros_like(flight.told.covariance)))
    np.testing.assert_allclose(
        bound(exact, inefficiency=6.0).translation_rms_m, bound(exact).translation_rms_m, rtol=1e-6
    )


def test_the_causal_bound_falls_to_the_whole(flight):
    causal, whole = causal_bound(flight), bound(flight)
    assert causal.translation_rms_m[-1] == pytest.approx(whole.translation_rms_m[-1])
    assert (causal.translation_rms_m >= whole.translation_rms_m - 1e-9).all()
    assert causal.model_rms_m == pytest.approx(whole.model_rms_m)


def test_a_frame_of_too_few_landmarks_has_no_bound_and_costs_the_others_nothing(flight):
    pixels = flight.observed.pixels.copy()
    pixels[[0, 3], 3:] = np.nan
    poor = replace(flight, observed=replace(flight.observed, pixels=pixels))
    found, causal = bound(poor), causal_bound(poor)
    rest = np.delete(np.arange(len(pixels)), [0, 3])
    for each in (found, causal):
        assert np.flatnonzero(np.isnan(each.translation_rms_m)).tolist() == [0, 3]
        assert np.isfinite(each.model_rms_m)
    whole = bound(flight)
    assert (found.translation_rms_m[rest] >= whole.translation_rms_m[rest]).all()
    np.testing.assert_allclose(found.translation_rms_m[rest], whole.translation_rms_m[rest], rtol=0.3)
