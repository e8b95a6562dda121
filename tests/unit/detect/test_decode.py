# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Outputs of networks to pixels, covariances and scores."""

import numpy as np
import pytest

from fairlead.detect.onnx.decode import decode
from fairlead.io.network_card import Calibration, Decoding, NetworkCard, NetworkInput

INPUT = NetworkInput(name="image", width=192, height=256)


def card(decoding: Decoding, n: int, **calibration: object) -> NetworkCard:
    names = tuple(f"l{j}" for j in range(n))
    return NetworkCard(
        name="c", landmarks=names, input=INPUT, decoding=decoding, calibration=Calibration(**calibration)
    )


def test_pixels_come_with_their_covariance() -> None:
    L = np.array([[2.0, 0.0], [-0.7, 0.5]])
    outputs = [np.array([[3.0, 4.0]] * 2), np.array([[np.log(2.0), np.log(0.5), -0.7]] * 2), np.array([1.5, -3.0])]
    found = decode(card(Decoding(), 2, scale=(1.0, 4.0), floor_px=0.3, visible_threshold=0.0), outputs)
    assert found.covariances[0] == pytest.approx(L @ L.T + 0.09 * np.eye(2))
    assert found.covariances[1] == pytest.approx(4.0 * L @ L.T + 0.09 * np.eye(2))
    assert found.pixels.tolist() == [[3.0, 4.0], [3.0, 4.0]]
    assert found.above(0.0).tolist() == [True, False]


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("which", [0, 1, 2])
def test_what_is_no_number_is_not_seen(bad: float, which: int) -> None:
    outputs = [np.zeros((2, 2)), np.zeros((2, 3)), np.ones(2)]
    outputs[which][0] = bad
    found = decode(card(Decoding(), 2), outputs)
    seen = found.above(0.0)
    assert seen[1]
    assert not seen[0] or (np.isfinite(found.pixels[0]).all() and np.isfinite(found.covariances[0]).all())


def simcc_label(at: np.ndarray, bins: int, sigma: float = 5.66) -> np.ndarray:
    """What a SimCC network is trained to say: a Gaussian about the position, two bins a pixel."""
    return np.exp(-0.5 * ((np.arange(bins) - 2.0 * at[:, None]) / sigma) ** 2)


def test_simcc_is_read_between_its_bins() -> None:
    rng = np.random.default_rng(3)
    u, v = rng.uniform(20.0, 170.0, 200), rng.uniform(20.0, 230.0, 200)
    found = decode(card(Decoding(kind="simcc"), 200, sigma_px=(1.0,)), [simcc_label(u, 384), simcc_label(v, 512)])
    truth = np.column_stack([u, v])
    assert np.abs(found.pixels - truth).max() < 0.01
    rounded = np.column_stack([np.round(2.0 * u), np.round(2.0 * v)]) / 2.0
    assert np.abs(rounded - truth).max() > 0.2  # what a highest bin alone would cost
    assert found.scores == pytest.approx(1.0, abs=0.01)
    assert found.covariances == pytest.approx(np.tile(np.eye(2), (200, 1, 1)))


def test_simcc_of_probabilities_and_another_origin() -> None:
    u, v = np.array([50.3]), np.array([101.9])
    p = [row / row.sum() for row in (simcc_label(u, 384, 3.0), simcc_label(v, 512, 3.0))]
    decoding = Decoding(kind="simcc", beta=0.0, window=12.0, origin_px=-0.25)
    found = decode(card(decoding, 1, sigma_px=(1.0,)), p)
    assert found.pixels[0] == pytest.approx([50.3 - 0.25, 101.9 - 0.25], abs=0.01)


def test_a_far_second_peak_does_not_draw_the_first() -> None:
    u = np.array([50.3])
    x = simcc_label(u, 384) + 0.9 * simcc_label(u + 80.0, 384)
    found = decode(card(Decoding(kind="simcc", beta=0.0, window=12.0), 1, sigma_px=(1.0,)), [x, x])
    assert found.pixels[0] == pytest.approx(50.3, abs=0.15)


def heat(at: np.ndarray, shape: tuple[int, int], sigma: float = 2.0) -> np.ndarray:
    r, c = np.indices(shape)
    return np.exp(-0.5 * ((c - at[:, :1, None]) ** 2 + (r - at[:, 1:, None]) ** 2) / sigma**2)


def test_heatmaps_are_read_between_their_cells() -> None:
    at = np.random.default_rng(4).uniform(8.0, 38.0, (100, 2))
    decoding = Decoding(kind="heatmap", stride=4.0, origin_px=1.5)
    found = decode(card(decoding, 100, sigma_px=(1.0,)), [heat(at, (64, 48))])
    assert np.abs(found.pixels - (4.0 * at + 1.5)).max() < 0.1  # a fortieth of a cell
    assert found.scores.max() <= 1.0


def test_a_heatmap_with_its_peak_at_the_border_or_none_at_all() -> None:
    at = np.array([[0.0, 0.0], [47.0, 63.0], [20.0, 63.0]])
    found = decode(card(Decoding(kind="heatmap"), 3, sigma_px=(1.0,)), [heat(at, (64, 48))])
    assert found.pixels == pytest.approx(4.0 * at)
    flat = decode(card(Decoding(kind="heatmap"), 1, sigma_px=(1.0,), spread_factor=1.0), [np.zeros((1, 64, 48))])
    assert not flat.above(0.0).any()


def test_a_broad_peak_widens_the_covariance_if_the_card_says_so() -> None:
    at = np.array([[20.2, 30.4]])
    decoding = Decoding(kind="heatmap", stride=4.0)
    told = [
        decode(card(decoding, 1, sigma_px=(2.0,), spread_factor=0.5), [heat(at, (64, 48), sigma)]).covariances[0]
        for sigma in (0.7, 1.0)
    ]
    for S, sigma in zip(told, (0.7, 1.0), strict=True):
        expected = (4.0 + 0.5 * 16.0 * sigma**2) * np.eye(2)
        assert pytest.approx(expected, rel=0.05, abs=0.05) == S
    x = simcc_label(np.array([50.0]), 384)
    simcc = card(Decoding(kind="simcc", beta=0.0, window=40.0), 1, sigma_px=(2.0,), spread_factor=1.0)
    assert decode(simcc, [x, x]).covariances[0] == pytest.approx((4.0 + (5.66 / 2.0) ** 2) * np.eye(2), rel=0.02)
