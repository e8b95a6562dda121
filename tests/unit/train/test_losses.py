# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The losses are the densities they say they are."""

import numpy as np
import pytest
import torch
from scipy.stats import multivariate_normal, multivariate_t

from fairlead.train.labels import Batch
from fairlead.train.losses import (
    covariance_loss,
    gaussian_loss,
    landmark_weight,
    mean_of,
    presence_loss,
    visibility_loss,
    whitened,
)
from fairlead.train.networks.prediction import Prediction


@pytest.fixture
def batch() -> Batch:
    return Batch(
        images=torch.zeros(1, 3, 8, 8, dtype=torch.uint8),
        pixels=torch.tensor([[[3.0, 4.0], [5.0, 1.0], [0.0, 0.0]]]),
        visibility=torch.tensor([[2, 1, 0]]),
    )


@pytest.fixture
def prediction() -> Prediction:
    return Prediction(
        pixels=torch.tensor([[[2.0, 6.0], [5.5, 0.0], [9.0, 9.0]]], requires_grad=True),
        cholesky=torch.tensor([[[0.3, -0.2, 0.7], [-0.5, 0.4, -0.3], [0.0, 0.0, 0.0]]], requires_grad=True),
        visible=torch.tensor([[1.0, -2.0, 0.5]]),
        present=torch.tensor([1.5]),
        maps=(),
    )


def factor(cholesky: np.ndarray) -> np.ndarray:
    return np.array([[np.exp(cholesky[0]), 0.0], [cholesky[2], np.exp(cholesky[1])]])


def test_errors_are_whitened_by_the_cholesky_factor(batch: Batch, prediction: Prediction) -> None:
    found = whitened(prediction, batch).detach().numpy()[0]
    for k in range(2):
        e = (batch.pixels[0, k] - prediction.pixels[0, k]).detach().numpy()
        assert np.allclose(found[k], np.linalg.solve(factor(prediction.cholesky[0, k].detach().numpy()), e), atol=1e-5)


def test_the_covariance_loss_is_a_student_t(batch: Batch, prediction: Prediction) -> None:
    """scipy's density of four degrees of freedom and shape L L^T, up to one constant."""
    found = covariance_loss(prediction, batch).detach().numpy()[0]
    oracle = [
        -multivariate_t(np.zeros(2), L @ L.T, df=4).logpdf((batch.pixels - prediction.pixels)[0, k].detach().numpy())
        for k in range(2)
        for L in [factor(prediction.cholesky[0, k].detach().numpy())]
    ]
    assert found[0] - found[1] == pytest.approx(oracle[0] - oracle[1], abs=1e-5)


def test_the_gaussian_loss_is_a_gaussian(batch: Batch, prediction: Prediction) -> None:
    found = gaussian_loss(prediction, batch).detach().numpy()[0]
    oracle = [
        -multivariate_normal(np.zeros(2), L @ L.T).logpdf((batch.pixels - prediction.pixels)[0, k].detach().numpy())
        for k in range(2)
        for L in [factor(prediction.cholesky[0, k].detach().numpy())]
    ]
    assert found[:2] + np.log(2.0 * np.pi) == pytest.approx(oracle, abs=1e-5)


def test_the_covariance_loss_moves_no_pixels(batch: Batch, prediction: Prediction) -> None:
    covariance_loss(prediction, batch).sum().backward()
    assert prediction.pixels.grad is None
    assert prediction.cholesky.grad is not None


def test_what_is_outside_weighs_nothing(batch: Batch, prediction: Prediction) -> None:
    weight = landmark_weight(batch)
    assert torch.allclose(weight, torch.tensor([[1.0, 0.3, 0.0]]))
    assert mean_of(torch.tensor([[1.0, 2.0, 1e6]]), weight).item() == pytest.approx(1.6 / 1.3)
    assert mean_of(torch.ones(1, 3), torch.zeros(1, 3)).item() == 0.0
    cross = visibility_loss(prediction, batch)[0]
    assert cross.tolist() == pytest.approx([np.log1p(np.exp(-1.0)), np.log1p(np.exp(-2.0)), np.log1p(np.exp(0.5))])


def test_a_hidden_landmark_shows_that_the_target_is_there(batch: Batch, prediction: Prediction) -> None:
    hidden, empty = torch.tensor([[0, 1, 0]]), torch.tensor([[0, 0, 0]])
    there = presence_loss(prediction, batch._replace(visibility=hidden)).item()
    assert there == pytest.approx(np.log1p(np.exp(-1.5)))
    assert presence_loss(prediction, batch._replace(visibility=empty)).item() == pytest.approx(there + 1.5)
