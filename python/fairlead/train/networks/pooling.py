# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Covariance and visibility of each landmark from the features where its heat is."""

import torch
from torch import Tensor, nn


class LandmarkHead(nn.Module):
    """A small network that all landmarks share, fed with features of the landmark and a vector of its own.

    Outputs log l11, log l22, l21 of the covariance's Cholesky factor [px] and the logit of being visible.
    """

    def __init__(self, landmarks: int, features: int, width: int = 64) -> None:
        super().__init__()
        self.own = nn.Parameter(0.1 * torch.randn(landmarks, 16))
        self.layers = nn.Sequential(
            nn.Linear(features + 16, width), nn.SiLU(), nn.Linear(width, width), nn.SiLU(), nn.Linear(width, 4)
        )

    def forward(self, features: Tensor) -> tuple[Tensor, Tensor]:
        """(b, n, features) -> cholesky (b, n, 3), visible (b, n)."""
        own = self.own.expand(features.shape[0], -1, -1)
        out = self.layers(torch.cat([features, own], dim=-1)).float()
        scales = 6.0 * torch.tanh(out[..., :2] / 6.0)  # e^-6 to e^6 px
        return torch.cat([scales, out[..., 2:3]], dim=-1), out[..., 3]
