# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Blocks that the networks share: convolutions with batch norm, and CSPNeXt's layer (Lyu et al. 2022, RTMDet)."""

import torch
from torch import Tensor, nn

from fairlead.train.crops import SCALE
from fairlead.train.networks.depthwise import DepthwiseConv2d

FAINT = 1.0 / SCALE
"""Contrast that is as good as none, one grey level: what is fainter stays faint."""


def even_contrast(images: Tensor) -> Tensor:
    """(b, 3, h, w) to mean 0 and variance 1 of each whole picture: no haze any more. docs/networks.md eq. (1)."""
    centred = images - images.mean((1, 2, 3), keepdim=True)
    variance = centred.square().mean((1, 2, 3), keepdim=True)
    return centred / torch.sqrt(variance + FAINT**2)


class ConvBnSiLU(nn.Sequential):
    """Convolution without bias, batch norm, SiLU; the size stays, up to the stride."""

    def __init__(self, inputs: int, outputs: int, size: int = 1, *, stride: int = 1) -> None:
        conv = nn.Conv2d(inputs, outputs, size, stride, size // 2, bias=False)
        super().__init__(conv, nn.BatchNorm2d(outputs), nn.SiLU(inplace=True))


class Separable(nn.Sequential):
    """Depthwise convolution, then a 1 x 1 one."""

    def __init__(self, inputs: int, outputs: int, size: int = 5) -> None:
        depthwise = nn.Sequential(DepthwiseConv2d(inputs, size), nn.BatchNorm2d(inputs), nn.SiLU(inplace=True))
        super().__init__(depthwise, ConvBnSiLU(inputs, outputs))


class CspNextBlock(nn.Module):
    """3 x 3, then separable 5 x 5; with or without identity."""

    def __init__(self, channels: int, *, identity: bool) -> None:
        super().__init__()
        self.conv = ConvBnSiLU(channels, channels, 3)
        self.separable = Separable(channels, channels)
        self.identity = identity

    def forward(self, x: Tensor) -> Tensor:
        """(b, c, h, w) -> (b, c, h, w)."""
        y = self.separable(self.conv(x))
        return x + y if self.identity else y


class ChannelAttention(nn.Module):
    """Each channel times a hard sigmoid of a 1 x 1 convolution of the mean."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.conv = nn.Conv2d(channels, channels, 1)
        self.gate = nn.Hardsigmoid()

    def forward(self, x: Tensor) -> Tensor:
        """(b, c, h, w) -> (b, c, h, w)."""
        return x * self.gate(self.conv(x.mean((2, 3), keepdim=True)))


class CspLayer(nn.Module):
    """Two branches of half the channels, one through the blocks; joined, attended, mixed."""

    def __init__(self, channels: int, blocks: int, *, identity: bool) -> None:
        super().__init__()
        half = channels // 2
        self.through = ConvBnSiLU(channels, half)
        self.past = ConvBnSiLU(channels, half)
        self.blocks = nn.Sequential(*(CspNextBlock(half, identity=identity) for _ in range(blocks)))
        self.attention = ChannelAttention(channels)
        self.mix = ConvBnSiLU(channels, channels)

    def forward(self, x: Tensor) -> Tensor:
        """(b, c, h, w) -> (b, c, h, w)."""
        joined = torch.cat([self.blocks(self.through(x)), self.past(x)], dim=1)
        return self.mix(self.attention(joined))


class PyramidPooling(nn.Module):
    """Max pools of 5, 9 and 13 cells beside the input, mixed (He et al. 2015)."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.narrow = ConvBnSiLU(channels, channels // 2)
        self.pools = nn.ModuleList(nn.MaxPool2d(size, 1, size // 2) for size in (5, 9, 13))
        self.mix = ConvBnSiLU(2 * channels, channels)

    def forward(self, x: Tensor) -> Tensor:
        """(b, c, h, w) -> (b, c, h, w)."""
        x = self.narrow(x)
        return self.mix(torch.cat([x, *(pool(x) for pool in self.pools)], dim=1))
