# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Depthwise convolution whose gradients in bfloat16 take forms that a processor is fast at. docs/networks.md section 4.

The gradient of a filter of size k at offset (i, j) is the sum over the image of the output's gradient times the input
moved by (i, j). Hence any 3 x 3 block of it is the gradient of a 3 x 3 filter over the moved input. The library under
torch has fast code in 16 bit for gradients of filters of 3 x 3 at stride 1, and for others next to none.
"""

from typing import Any

import torch
import torch.nn.functional as F
from torch import Tensor, nn

BLOCK = 3


class DepthwiseConv2d(nn.Conv2d):
    """One odd filter of at least 3 x 3 a channel, without bias; values and gradients as nn.Conv2d's."""

    def __init__(self, channels: int, size: int, stride: int = 1) -> None:
        super().__init__(channels, channels, size, stride, size // 2, groups=channels, bias=False)

    def forward(self, input: Tensor) -> Tensor:  # noqa: A002
        """(b, c, h, w) -> (b, c, ceil(h / stride), ceil(w / stride))."""
        kind = torch.get_autocast_dtype("cpu") if torch.is_autocast_enabled("cpu") else input.dtype
        if input.is_cpu and self.training and kind is torch.bfloat16:
            return Depthwise.apply(input.to(kind), self.weight.to(kind), self.stride[0])  # type: ignore[no-any-return]
        return super().forward(input)


class Depthwise(torch.autograd.Function):
    """y = x * w by channel, with padding of half the filter."""

    @staticmethod
    def forward(ctx: Any, x: Tensor, w: Tensor, stride: int) -> Tensor:
        """Keeps what the gradients need."""
        ctx.save_for_backward(x, w)
        ctx.stride = stride
        return F.conv2d(x, w, stride=stride, padding=w.shape[-1] // 2, groups=len(w))

    @staticmethod
    def backward(ctx: Any, *gradients: Tensor) -> tuple[Tensor, Tensor, None]:
        """Of the input: the turned filter over the gradient, spread out by the stride. Of the filter: by blocks."""
        x, w = ctx.saved_tensors
        (g,) = gradients
        full = spread(g, ctx.stride, x.shape) if ctx.stride > 1 else g
        of_x = F.conv2d(full, w.flip(2, 3), padding=w.shape[-1] // 2, groups=len(w))
        return of_x, weight_gradient(x, g, w, ctx.stride), None


def spread(g: Tensor, stride: int, shape: torch.Size) -> Tensor:
    """The gradient at the places of the input that it came from, zero between them."""
    full = torch.zeros(shape, dtype=g.dtype).contiguous(memory_format=torch.channels_last)
    full[:, :, ::stride, ::stride] = g
    return full


def weight_gradient(x: Tensor, g: Tensor, w: Tensor, stride: int) -> Tensor:
    """(c, 1, k, k) in blocks of 3 x 3, the last ones overlapping."""
    k = w.shape[-1]
    starts = sorted({*range(0, k - BLOCK, BLOCK), k - BLOCK})
    padded = F.pad(x, (k // 2,) * 4)
    height, width = ((size - 1) * stride + BLOCK for size in g.shape[2:])
    block, out = w[:, :, :BLOCK, :BLOCK].contiguous(), torch.empty_like(w)
    for i in starts:
        for j in starts:
            moved = padded[:, :, i : i + height, j : j + width].contiguous(memory_format=torch.channels_last)
            _, found, _ = torch.ops.aten.convolution_backward(
                g, moved, block, None, [stride] * 2, [0, 0], [1, 1], False, [0, 0], len(w),  # noqa: FBT003
                [False, True, False],
            )  # fmt: skip
            out[:, :, i : i + BLOCK, j : j + BLOCK] = found
    return out
