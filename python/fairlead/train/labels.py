# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A batch of crops with their labels."""

from typing import NamedTuple

from torch import Tensor


class Batch(NamedTuple):
    """b crops, n landmarks; pixels of the crop, (0, 0) at the centre of the top-left one."""

    images: Tensor
    """(b, 3, h, w) 8 bit, blue green red."""
    pixels: Tensor
    """(b, n, 2)"""
    visibility: Tensor
    """(b, n): 0 outside the crop, 1 hidden, 2 visible."""
