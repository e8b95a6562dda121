# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""RTMPose (Jiang et al. 2023): CSPNeXt, a gated attention unit over landmarks, SimCC.

What is published, and beside it covariance, visibility and presence. SimCC (Li et al. 2022): one row of
bins for each axis, BINS a pixel; bin i lies at i / BINS px.
"""

import torch
from torch import Tensor, nn

from fairlead.train.networks.attention import GatedAttention, ScaleNorm
from fairlead.train.networks.cspnext import CspNext
from fairlead.train.networks.layers import even_contrast
from fairlead.train.networks.pooling import LandmarkHead, Presence, seen_if_present
from fairlead.train.networks.prediction import Prediction

BINS = 2
"""Of a row, a pixel."""
REACH = 16
"""Bins to either side of the highest that the expectation is taken over."""
DIMENSION = 256
SIGMA_BINS = 5.66
"""Of the label in a row of 256 px; labels are not rounded to bins."""
MAP_WEIGHT = 256.0
"""The mean over bins is small beside the other losses."""


class RtmPose(nn.Module):
    """rtmpose-t, -s, -m for crops of one size (width, height), multiples of 32 px."""

    def __init__(self, landmarks: int, size: str = "t", crop: tuple[int, int] = (256, 256)) -> None:
        super().__init__()
        width, height = crop
        self.backbone = CspNext(size)
        self.tokens = nn.Conv2d(self.backbone.channels[-1], landmarks, 7, padding=3)
        cells = (width // 32) * (height // 32)
        self.lift = nn.Sequential(ScaleNorm(cells), nn.Linear(cells, DIMENSION, bias=False))
        self.attention = GatedAttention(DIMENSION)
        self.across = nn.Linear(DIMENSION, BINS * width, bias=False)
        self.down = nn.Linear(DIMENSION, BINS * height, bias=False)
        self.landmark = LandmarkHead(landmarks, DIMENSION + 4)
        self.presence = Presence(self.backbone.channels[-1])

    def forward(self, images: Tensor) -> Prediction:
        """(b, 3, h, w), normalised."""
        features = self.backbone(even_contrast(images))[-1]
        tokens = self.attention(self.lift(self.tokens(features).flatten(2)))
        rows = (self.across(tokens).float(), self.down(tokens).float())
        found = [row_expectation(row) for row in rows]
        pixels = torch.stack([at for at, _ in found], dim=-1)
        known = torch.cat([tokens, *(what for _, what in found)], dim=-1)
        cholesky, seen = self.landmark(known)
        present = self.presence(features)
        visible = seen_if_present(seen, present)
        return Prediction(pixels=pixels, cholesky=cholesky, visible=visible, present=present, maps=rows)

    def map_loss(self, maps: tuple[Tensor, ...], pixels: Tensor) -> Tensor:
        """(b, n): divergence of the label's softmax from the row's, x and y, mean over bins; both times 10."""
        total = torch.zeros(pixels.shape[:2], device=pixels.device)
        for axis, row in enumerate(maps):
            bins = torch.arange(row.shape[-1], device=row.device)
            sigma = SIGMA_BINS * (row.shape[-1] / BINS / 256.0) ** 0.5
            label = torch.exp(-0.5 * ((bins - BINS * pixels[..., axis, None]) / sigma) ** 2)
            wanted = (10.0 * label).softmax(-1)
            total = total + (wanted * (wanted.log() - (10.0 * row).log_softmax(-1))).mean(-1)
        return MAP_WEIGHT * total


def row_expectation(row: Tensor) -> tuple[Tensor, Tensor]:
    """Place [px] (b, n) of the highest bin to a fraction, and (b, n, 2): that bin's logit, the spread about it."""
    bins = row.shape[-1]
    highest, at = row.max(dim=2)
    index = at[..., None] + torch.arange(-REACH, REACH + 1, device=row.device)
    inside = (index >= 0) & (index < bins)
    index = index.clamp(0, bins - 1)
    weight = (10.0 * row).gather(2, index).masked_fill(~inside, -1e4).softmax(dim=2)
    place = index.to(row.dtype)
    mean = (weight * place).sum(2)
    spread = (weight * (place - mean[..., None]).square()).sum(2)
    return mean / BINS, torch.stack([highest, torch.log(spread + 1e-3)], dim=-1)
