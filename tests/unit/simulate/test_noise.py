# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fairlead.simulate import Noise
from fairlead.simulate.streams import Streams

K, N = 400, 100
TURNS = np.arange(K) / 25.0


def draw(noise: Noise, seed: int = 1, turns=TURNS, n: int = N) -> np.ndarray:
    """Errors (k, n, 2) where all sigmas are sigma_px."""
    away = np.tile([1000.0, 0.0, 0.0], (len(turns), 1))
    return noise.draw(turns, away, np.full((len(turns), n), noise.sigma_px), Streams(seed))


@given(st.floats(0.05, 1.0), st.floats(0.2, 5.0), st.integers(0, 1000))
def test_alike_in_time_with_the_variance_of_white_noise(tau_s, sigma_px, seed):
    """Stationary: var = sigma^2 from the first image on, lag-1 correlation exp(-dt / tau); 5 standard errors.

    200 chains of 400 images; n_eff = (1 - a) / (1 + a) of them are independent for the mean of the squares of a^2.
    """
    a = np.exp(-1 / 25 / tau_s)
    e = draw(Noise(sigma_px=sigma_px, correlation_time_s=tau_s), seed) / sigma_px
    independent = e.size * (1 - a**2) / (1 + a**2)
    assert np.mean(e**2) == pytest.approx(1.0, abs=5 * np.sqrt(2 / independent))
    assert np.mean(e[0] ** 2) == pytest.approx(1.0, abs=5 * np.sqrt(2 / e[0].size))
    assert np.mean(e[1:] * e[:-1]) == pytest.approx(a, abs=5 * np.sqrt(2 / independent))
    far = int(np.ceil(8 * tau_s * 25))
    if far < K // 2:
        assert abs(np.mean(e[far:] * e[:-far])) < 5 * np.sqrt(2 / independent)


def test_spectrum_is_that_of_the_first_order_process():
    """The mean periodogram of 200 chains is sigma^2 (1 - a^2) / |1 - a exp(-i w)|^2: 10 % in bands of 20 lines."""
    a = np.exp(-1 / 25 / 0.2)
    e = draw(Noise(correlation_time_s=0.2), turns=np.arange(4000) / 25.0)
    power = (np.abs(np.fft.rfft(e, axis=0)) ** 2).mean(axis=(1, 2)) / len(e)
    w = 2 * np.pi * np.arange(len(power)) / len(e)
    expected = (1 - a**2) / np.abs(1 - a * np.exp(-1j * w)) ** 2
    bands = (power[1:2001].reshape(-1, 20).mean(axis=1), expected[1:2001].reshape(-1, 20).mean(axis=1))
    np.testing.assert_allclose(bands[0], bands[1], rtol=0.1)


def test_the_time_between_images_counts():
    """Neighbours that are 1 s apart among others at 0.04 s are as alike as exp(-1 / tau)."""
    turns = np.array([0.0, 0.04, 1.04, 1.08])
    e = draw(Noise(correlation_time_s=0.5), turns=turns, n=40_000)
    alike = [np.mean(e[k] * e[k + 1]) for k in range(3)]
    np.testing.assert_allclose(alike, np.exp(-np.diff(turns) / 0.5), atol=5 / np.sqrt(80_000))


def test_errors_stay_while_the_view_stays():
    """exp(-chord / 12 deg - |log range ratio| / 0.5) whatever the time between; 8000 fields of variance 1.

    The correlation of one draw of 256 waves scatters by 1 / sqrt(512): 5 of these.
    """
    angles = np.radians([0.0, 0.0, 6.0, 24.0, 0.0])
    ranges = np.array([1000.0, 1000.0, 1000.0, 1000.0, 500.0])
    away = ranges[:, None] * np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    noise = Noise(correlation_angle_deg=12.0, correlation_log_range=0.5)
    e = noise.draw(np.arange(5.0), away, np.ones((5, 4000)), Streams(1))
    chord = 2 * np.sin(angles / 2)
    alike = np.exp(-chord / np.radians(12.0) - np.log(1000.0 / ranges) / 0.5)
    found = [float(np.mean(e[0] * e[k])) for k in range(5)]
    np.testing.assert_allclose(found, alike, atol=5 / np.sqrt(512))
    assert found[0] == pytest.approx(1.0, abs=5 * np.sqrt(2 / 8000))
    np.testing.assert_array_equal(e[0], e[1])


def test_errors_stay_in_time_too():
    """Times exp(-dt / tau) where both are told."""
    away = np.tile([1000.0, 0.0, 0.0], (3, 1))
    noise = Noise(correlation_angle_deg=12.0, correlation_time_s=2.0)
    e = noise.draw(np.array([0.0, 1.0, 6.0]), away, np.ones((3, 4000)), Streams(2))
    found = [float(np.mean(e[0] * e[k])) for k in range(3)]
    np.testing.assert_allclose(found, np.exp([0.0, -0.5, -3.0]), atol=5 / np.sqrt(512))


def test_heavy_tails_keep_the_variance_and_both_coordinates_suffer():
    """Student's t with 5 degrees: variance sigma^2, share beyond 4 sigma 0.0050 (Gaussian 0.00034 of radius > 4)."""
    dof = 5.0
    e = draw(Noise(sigma_px=2.0, tail_dof=dof), turns=np.arange(2000) / 25.0) / 2.0
    assert np.mean(e**2) == pytest.approx(1.0, rel=0.03)
    radius = np.linalg.norm(e, axis=2)
    beyond = (1 + 16 / (dof - 2)) ** (-dof / 2)  # survival of the radius of the bivariate t of unit variance
    assert np.mean(radius > 4.0) == pytest.approx(beyond, rel=0.1)
    assert np.corrcoef(e[..., 0].ravel() ** 2, e[..., 1].ravel() ** 2)[0, 1] > 0.1


def test_sigma_grows_with_range_and_with_the_slant():
    """Half the range at exponent 0.5: sqrt(1/2). Gain 2: 1 straight ahead, 2 from the side, 3 from behind."""
    noise = Noise(sigma_px=1.0, reference_range_m=1000.0, range_exponent=0.5, aspect_gain=2.0)
    ranges, cosines = np.array([[500.0, 1000.0, 1000.0, 1000.0]]), np.array([[1.0, 1.0, 0.0, -1.0]])
    sigmas = noise.sigmas(ranges, cosines)
    np.testing.assert_allclose(sigmas, [[np.sqrt(0.5), 1.0, 2.0, 3.0]])
    np.testing.assert_array_equal(noise.told_sigmas(sigmas), sigmas)
    constant = Noise(sigma_px=0.5, told="constant", told_factor=3.0)
    np.testing.assert_array_equal(constant.told_sigmas(sigmas), np.full((1, 4), 1.5))


def test_a_bias_stays_and_differs_between_landmarks():
    biased = draw(Noise(bias_px=3.0)) - draw(Noise())
    np.testing.assert_allclose(biased, np.broadcast_to(biased[:1], biased.shape), atol=1e-12)
    assert biased[0].std() == pytest.approx(3.0, rel=5 / np.sqrt(2 * 2 * N))
    X = np.zeros((500, 3))
    assert Noise(bias_m=0.2).found_instead(X, Streams(1)).std() == pytest.approx(0.2, rel=5 / np.sqrt(3000))
    assert Noise().found_instead(X, Streams(1)) is X


@pytest.mark.parametrize(
    "values", [{"sigma_px": 0.0}, {"tail_dof": 2.0}, {"told_factor": -1.0}, {"bias_px": float("nan")}]
)
def test_impossible_noise_is_refused(values):
    with pytest.raises(ValueError, match=f"^{next(iter(values))}: expected"):
        Noise(**values)
