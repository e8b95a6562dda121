# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Lite-HRNet 18 in its wider naive form (Yu et al. 2021, table 1), the backbone of PP-TinyPose."""

from collections.abc import Sequence
from typing import cast

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from fairlead.train.networks.depthwise import DepthwiseConv2d

WIDTHS = (40, 80, 160, 320)
MODULES = (2, 4, 2)
"""Of the stages with two, three and four branches."""
UNITS = 2
"""Shuffle units of a branch."""


def conv_norm(inputs: int, outputs: int, size: int = 1, stride: int = 1) -> list[nn.Module]:
    """Convolution without bias and batch norm."""
    return [nn.Conv2d(inputs, outputs, size, stride, size // 2, bias=False), nn.BatchNorm2d(outputs)]


def depthwise_norm(channels: int, stride: int = 1) -> list[nn.Module]:
    """Depthwise 3 x 3 and batch norm."""
    return [DepthwiseConv2d(channels, 3, stride), nn.BatchNorm2d(channels)]


def shuffle(x: Tensor) -> Tensor:
    """Channels of two halves taken in turns."""
    b, c, h, w = x.shape
    return x.reshape(b, 2, c // 2, h, w).transpose(1, 2).reshape(b, c, h, w)


class Stem(nn.Module):
    """3 to 32 channels at stride 4: a plain convolution, then two depthwise branches."""

    def __init__(self) -> None:
        super().__init__()
        self.first = nn.Sequential(*conv_norm(3, 32, 3, 2), nn.ReLU(inplace=True))
        self.left = nn.Sequential(*depthwise_norm(16, 2), *conv_norm(16, 16), nn.ReLU(inplace=True))
        self.right = nn.Sequential(
            *conv_norm(16, 32),
            nn.ReLU(inplace=True),
            *depthwise_norm(32, 2),
            *conv_norm(32, 16),
            nn.ReLU(inplace=True),
        )

    def forward(self, x: Tensor) -> Tensor:
        """(b, 3, h, w) -> (b, 32, h / 4, w / 4)."""
        left, right = self.first(x).chunk(2, dim=1)
        return shuffle(torch.cat([self.left(left), self.right(right)], dim=1))


class ShuffleUnit(nn.Module):
    """Half the channels go through 1 x 1, depthwise 3 x 3, 1 x 1 (Ma et al. 2018, ShuffleNet V2)."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        half = channels // 2
        self.through = nn.Sequential(
            *conv_norm(half, half), nn.ReLU(inplace=True),
            *depthwise_norm(half),
            *conv_norm(half, half), nn.ReLU(inplace=True),
        )  # fmt: skip

    def forward(self, x: Tensor) -> Tensor:
        """(b, c, h, w) -> (b, c, h, w)."""
        past, half = x.chunk(2, dim=1)
        return shuffle(torch.cat([past, self.through(half)], dim=1))


def narrower(inputs: int, outputs: int, steps: int) -> nn.Module:
    """Down by 2^steps: depthwise convolutions of stride 2, each with a 1 x 1; the last widens."""
    layers: list[nn.Module] = []
    for step in range(steps):
        last = step == steps - 1
        layers += [*depthwise_norm(inputs, 2), *conv_norm(inputs, outputs if last else inputs)]
        if not last:
            layers.append(nn.ReLU(inplace=True))
    return nn.Sequential(*layers)


class Module(nn.Module):
    """Branches side by side, then every branch gets the sum of all, at its own size."""

    def __init__(self, widths: tuple[int, ...]) -> None:
        super().__init__()
        self.branches = nn.ModuleList(nn.Sequential(*(ShuffleUnit(c) for _ in range(UNITS))) for c in widths)
        self.fuse = nn.ModuleList(
            nn.ModuleList(
                nn.Identity() if i == j
                else nn.Sequential(*conv_norm(widths[j], widths[i])) if j > i
                else narrower(widths[j], widths[i], i - j)
                for j in range(len(widths))
            )
            for i in range(len(widths))
        )  # fmt: skip

    def forward(self, maps: list[Tensor]) -> list[Tensor]:
        """One map a branch, sizes halving."""
        maps = [branch(x) for branch, x in zip(self.branches, maps, strict=True)]
        out: list[Tensor] = []
        for i, row in enumerate(cast(Sequence[Sequence[nn.Module]], self.fuse)):
            total = torch.zeros_like(maps[i])
            for j, layer in enumerate(row):
                y = layer(maps[j])
                total = total + (F.interpolate(y, scale_factor=float(2 ** (j - i))) if j > i else y)
            out.append(F.relu(total))
        return out


def separable(inputs: int, outputs: int, stride: int = 1) -> nn.Module:
    """Depthwise 3 x 3, then 1 x 1."""
    layers = [*depthwise_norm(inputs, stride), *conv_norm(inputs, outputs), nn.ReLU(inplace=True)]
    return nn.Sequential(*layers)


class LiteHrNet(nn.Module):
    """Image to a map of stride 4, after a head that goes from coarse to fine, and the coarsest of the branches."""

    def __init__(self) -> None:
        super().__init__()
        self.stem = Stem()
        self.enter = nn.ModuleList()
        self.stages = nn.ModuleList()
        before: tuple[int, ...] = (32,)
        for stage, modules in enumerate(MODULES):
            widths = WIDTHS[: stage + 2]
            enter = [separable(c, w) if c != w else nn.Identity() for c, w in zip(before, widths[:-1], strict=True)]
            self.enter.append(nn.ModuleList([*enter, separable(before[-1], widths[-1], 2)]))
            self.stages.append(nn.ModuleList(Module(widths) for _ in range(modules)))
            before = widths
        self.head = nn.ModuleList(
            separable(WIDTHS[i], WIDTHS[i - 1] if i else WIDTHS[0]) for i in reversed(range(len(WIDTHS)))
        )

    def forward(self, x: Tensor) -> tuple[Tensor, Tensor]:
        """(b, 3, h, w) -> (b, WIDTHS[0], h / 4, w / 4), (b, WIDTHS[-1], h / 32, w / 32)."""
        maps = [self.stem(x)]
        steps = cast(tuple[Sequence[Sequence[nn.Module]], Sequence[Sequence[nn.Module]]], (self.enter, self.stages))
        for enter, stage in zip(*steps, strict=True):
            maps = [layer(maps[min(i, len(maps) - 1)]) for i, layer in enumerate(enter)]
            for module in stage:
                maps = module(maps)
        y: Tensor | None = None
        for layer, x in zip(self.head, reversed(maps), strict=True):
            if y is not None:
                x = x + F.interpolate(y, size=x.shape[2:], mode="bilinear", align_corners=False)
            y = layer(x)
        assert y is not None
        return y, maps[-1]
