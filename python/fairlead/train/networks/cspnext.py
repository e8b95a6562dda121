# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""CSPNeXt, the backbone of RTMPose (Jiang et al. 2023, section 3.1; Lyu et al. 2022, table 2)."""

from dataclasses import dataclass

from torch import Tensor, nn

from fairlead.train.networks.layers import ConvBnSiLU, CspLayer, PyramidPooling


@dataclass(frozen=True)
class Size:
    """How wide and deep."""

    channels: tuple[int, int, int, int, int]
    """After the stem (stride 2) and the four stages (strides 4, 8, 16, 32)."""
    blocks: tuple[int, int, int, int]


SIZES = {
    "t": Size((24, 48, 96, 192, 384), (1, 1, 1, 1)),
    "s": Size((32, 64, 128, 256, 512), (1, 2, 2, 1)),
    "m": Size((48, 96, 192, 384, 768), (2, 4, 4, 2)),
}


class CspNext(nn.Module):
    """Image to feature maps of strides 4, 8, 16 and 32."""

    def __init__(self, size: str) -> None:
        super().__init__()
        first, *widths = SIZES[size].channels
        self.channels = tuple(widths)
        self.stem = nn.Sequential(
            ConvBnSiLU(3, first // 2, 3, stride=2),
            ConvBnSiLU(first // 2, first // 2, 3),
            ConvBnSiLU(first // 2, first, 3),
        )
        before = [first, *widths[:-1]]
        self.stages = nn.ModuleList(
            nn.Sequential(
                ConvBnSiLU(before[i], width, 3, stride=2),
                *([PyramidPooling(width)] if i == 3 else []),
                CspLayer(width, SIZES[size].blocks[i], identity=i < 3),
            )
            for i, width in enumerate(widths)
        )

    def forward(self, x: Tensor) -> list[Tensor]:
        """(b, 3, h, w), h and w multiples of 32 -> maps of strides 4, 8, 16, 32."""
        x = self.stem(x)
        maps = []
        for stage in self.stages:
            x = stage(x)
            maps.append(x)
        return maps
