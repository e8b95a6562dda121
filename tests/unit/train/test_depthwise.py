# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Gradients by blocks are those of nn.Conv2d."""

import pytest
import torch

from fairlead.train.networks.depthwise import Depthwise, DepthwiseConv2d

SHAPES = [(3, 1, 16, 16), (5, 1, 12, 9), (7, 1, 16, 16), (3, 2, 16, 16), (5, 2, 15, 11), (3, 2, 9, 14)]


@pytest.mark.parametrize(("size", "stride", "rows", "columns"), SHAPES)
def test_gradients_are_those_of_a_plain_convolution(size: int, stride: int, rows: int, columns: int) -> None:
    torch.manual_seed(0)
    x = torch.randn(2, 6, rows, columns, requires_grad=True)
    w = torch.randn(6, 1, size, size, requires_grad=True)
    plain = torch.nn.functional.conv2d(x, w, stride=stride, padding=size // 2, groups=6)
    ours = Depthwise.apply(x, w, stride)
    assert torch.equal(ours, plain)
    g = torch.randn_like(plain)
    expected = torch.autograd.grad(plain, (x, w), g)
    for found, right in zip(torch.autograd.grad(ours, (x, w), g), expected, strict=True):
        torch.testing.assert_close(found, right, rtol=1e-4, atol=1e-4)


def test_it_stands_in_where_a_network_learns_in_16_bit() -> None:
    """And is a plain convolution everywhere else."""
    layer, x = DepthwiseConv2d(4, 5), torch.randn(1, 4, 8, 8)
    with torch.autocast("cpu", torch.bfloat16):
        learning, looking = layer.train()(x), layer.eval()(x)
    assert "Depthwise" in type(learning.grad_fn).__name__
    assert learning.dtype == looking.dtype == torch.bfloat16
    torch.testing.assert_close(learning, looking)
    assert "Depthwise" not in type(layer.train()(x).grad_fn).__name__
