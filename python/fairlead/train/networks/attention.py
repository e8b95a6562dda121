# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Gated attention unit (Hua et al. 2022, "Transformer quality in linear time", section 3) as RTMPose uses it."""

import math

import torch
import torch.nn.functional as F
from torch import Tensor, nn


class ScaleNorm(nn.Module):
    """x / (|x| / sqrt(d)) times one learned number."""

    def __init__(self, dimension: int) -> None:
        super().__init__()
        self.root = math.sqrt(dimension)
        self.g = nn.Parameter(torch.ones(1))

    def forward(self, x: Tensor) -> Tensor:
        """(..., d) -> (..., d)."""
        return self.g * (self.root * x / x.norm(dim=-1, keepdim=True).clamp_min(1e-5))


class GatedAttention(nn.Module):
    """One token a landmark; squared ReLU of q k^T / sqrt(base) weighs the values, a gate multiplies them."""

    def __init__(self, dimension: int = 256, base: int = 128, wide: int = 512) -> None:
        super().__init__()
        self.wide, self.base = wide, base
        self.norm = ScaleNorm(dimension)
        self.inside = nn.Linear(dimension, 2 * wide + base, bias=False)
        self.gamma = nn.Parameter(torch.rand(2, base))
        self.beta = nn.Parameter(torch.rand(2, base))
        self.outside = nn.Linear(wide, dimension, bias=False)
        self.residual = nn.Parameter(torch.ones(dimension))

    def forward(self, x: Tensor) -> Tensor:
        """(b, n, d) -> (b, n, d)."""
        gate, value, shared = F.silu(self.inside(self.norm(x))).split([self.wide, self.wide, self.base], dim=-1)
        query, key = (shared[..., None, :] * self.gamma + self.beta).unbind(dim=-2)
        kernel = F.relu(query @ key.transpose(1, 2) / math.sqrt(self.base)).square()
        return self.residual * x + self.outside(gate * (kernel @ value))
