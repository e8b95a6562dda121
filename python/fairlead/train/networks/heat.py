# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The default network: CSPNeXt, light upsampling to stride 4, one heatmap a landmark, local expectation.

A landmark is where its heat is highest, to a fraction of a cell by the expectation in a window about it; covariance
and visibility come from the features there. All but that pooling is convolution: any multiple of 32 px will do.
docs/networks.md section 2.
"""

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from fairlead.train.networks.cspnext import CspNext
from fairlead.train.networks.layers import ConvBnSiLU, Separable, even_contrast
from fairlead.train.networks.pooling import LandmarkHead, Presence, seen_if_present
from fairlead.train.networks.prediction import Prediction

STRIDE = 4
"""Pixels of a cell; cell i has its centre at STRIDE i + (STRIDE - 1) / 2."""
WIDTH = 64
SIGMA = 1.5
"""Of the label's heat [cells]."""
REACH = 3
"""Cells to either side of the highest that the expectation is taken over."""


class Heat(nn.Module):
    """heat-t, -s, -m."""

    def __init__(self, landmarks: int, size: str = "t") -> None:
        super().__init__()
        self.backbone = CspNext(size)
        self.lateral = nn.ModuleList(ConvBnSiLU(channels, WIDTH) for channels in self.backbone.channels)
        self.smooth = nn.ModuleList(Separable(WIDTH, WIDTH) for _ in self.backbone.channels)
        self.last = nn.Sequential(Separable(WIDTH, WIDTH), Separable(WIDTH, WIDTH))
        self.heat = nn.Conv2d(WIDTH, landmarks, 1)
        self.landmark = LandmarkHead(landmarks, WIDTH + 3)
        self.presence = Presence(self.backbone.channels[-1])

    def forward(self, images: Tensor) -> Prediction:
        """(b, 3, h, w), normalised."""
        maps = self.backbone(even_contrast(images))
        x = self.smooth[3](self.lateral[3](maps[3]))
        for level in (2, 1, 0):
            x = self.smooth[level](self.lateral[level](maps[level]) + F.interpolate(x, scale_factor=2.0))
        x = self.last(x)
        logits = self.heat(x).float()
        pixels, known = expectation(logits, x.float())
        cholesky, seen = self.landmark(known)
        present = self.presence(maps[-1])
        visible = seen_if_present(seen, present)
        return Prediction(pixels=pixels, cholesky=cholesky, visible=visible, present=present, maps=(logits,))

    def map_loss(self, maps: tuple[Tensor, ...], pixels: Tensor) -> Tensor:
        """(b, n): cross entropy of the map's softmax to a Gaussian of SIGMA cells, less the Gaussian's entropy."""
        (logits,) = maps
        across, down = gaussian_rows(pixels, logits.shape[3], logits.shape[2], SIGMA)
        across = across / across.sum(-1, keepdim=True).clamp_min(1e-12)
        down = down / down.sum(-1, keepdim=True).clamp_min(1e-12)
        inner = torch.einsum("bnhw,bnh,bnw->bn", logits, down, across)
        entropy = -(torch.xlogy(across, across).sum(-1) + torch.xlogy(down, down).sum(-1))
        return logits.flatten(2).logsumexp(2) - inner - entropy


def gaussian_rows(pixels: Tensor, columns: int, rows: int, sigma: float) -> tuple[Tensor, Tensor]:
    """exp(-d^2 / (2 sigma^2)) of the cells of a row (b, n, columns) and of a column (b, n, rows), at most 1."""
    at = (pixels - 0.5 * (STRIDE - 1)) / STRIDE
    u = torch.arange(columns, device=pixels.device)
    v = torch.arange(rows, device=pixels.device)
    return torch.exp(-0.5 * ((u - at[..., :1]) / sigma) ** 2), torch.exp(-0.5 * ((v - at[..., 1:]) / sigma) ** 2)


def expectation(logits: Tensor, features: Tensor) -> tuple[Tensor, Tensor]:
    """Pixels (b, n, 2) of the highest heat, and what is known there (b, n, c + 3).

    mean of the cell centres in a window of 2 REACH + 1 cells about the highest, weighed by the softmax in it; known are
    the features, weighed alike, the highest logit, the window's share of the whole map's softmax, and its width.
    """
    b, n, h, w = logits.shape
    flat = logits.flatten(2)
    highest, at = flat.max(dim=2)
    reach = torch.arange(-REACH, REACH + 1, device=logits.device)
    rows = (at // w)[..., None] + reach
    columns = (at % w)[..., None] + reach
    inside = ((rows >= 0) & (rows < h))[..., :, None] & ((columns >= 0) & (columns < w))[..., None, :]
    index = (rows.clamp(0, h - 1)[..., :, None] * w + columns.clamp(0, w - 1)[..., None, :]).flatten(2)
    inside = inside.flatten(2)
    local = flat.gather(2, index).masked_fill(~inside, -1e4)
    weight = local.softmax(dim=2)
    u = (index % w).to(weight.dtype)
    v = torch.div(index, w, rounding_mode="floor").to(weight.dtype)
    mean_u, mean_v = (weight * u).sum(2), (weight * v).sum(2)
    pixels = STRIDE * torch.stack([mean_u, mean_v], dim=-1) + 0.5 * (STRIDE - 1)
    width = (weight * ((u - mean_u[..., None]) ** 2 + (v - mean_v[..., None]) ** 2)).sum(2)
    share = local.logsumexp(2) - flat.logsumexp(2)
    c = features.shape[1]
    picked = features.flatten(2).gather(2, index.reshape(b, 1, -1).expand(-1, c, -1)).reshape(b, c, n, -1)
    pooled = (picked * weight[:, None]).sum(3).transpose(1, 2)
    known = torch.stack([0.1 * highest, share, torch.log(width + 1e-3)], dim=-1)
    return pixels, torch.cat([pooled, known], dim=-1)
