# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What every network returns, and the loss that any of them is trained with."""

from dataclasses import dataclass

from torch import Tensor


@dataclass(frozen=True, kw_only=True)
class Prediction:
    """Of a batch of b crops with n landmarks each; pixels of the crop, (0, 0) at the centre of the top-left one."""

    pixels: Tensor
    """(b, n, 2)"""
    cholesky: Tensor
    """(b, n, 3): log l11, log l22, l21 of the covariance L L^T [px]."""
    visible: Tensor
    """(b, n) logit of the landmark being seen."""
    present: Tensor
    """(b,) logit of the target being in the crop; `visible` has it in it."""
    maps: tuple[Tensor, ...]
    """What the labels are compared with: heatmap logits (b, n, h, w), or two of SimCC (b, n, bins)."""
