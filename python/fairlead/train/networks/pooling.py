# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Covariance and visibility of each landmark from the features where its heat is; and whether the target is there."""

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


class Presence(nn.Module):
    """Whether the target is in the picture at all, from the coarsest map: a logit a cell, m, and

    p = sum softmax(m) m

    which is near the highest, wherever it is and however large the picture.
    """

    def __init__(self, features: int, width: int = 64) -> None:
        super().__init__()
        self.layers = nn.Sequential(nn.Conv2d(features, width, 1), nn.SiLU(), nn.Conv2d(width, 1, 1))

    def forward(self, features: Tensor) -> Tensor:
        """(b, features, h, w) -> (b,) logit."""
        cells = self.layers(features).float().flatten(1)
        return (cells.softmax(1) * cells).sum(1)


def seen_if_present(seen: Tensor, present: Tensor) -> Tensor:
    """(b, n) logit of sigma(seen) sigma(present): a landmark is seen if the target is there and it is not hidden.

    -log(e^-s + e^-p + e^-(s + p))
    """
    present = present[:, None].expand_as(seen)
    return -torch.stack([-seen, -present, -seen - present], dim=-1).logsumexp(-1)
