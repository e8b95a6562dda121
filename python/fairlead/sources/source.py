# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What every source is: an iterable of frames that knows how much work there is."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import UInt8

from fairlead.types import View

Image = UInt8[np.ndarray, "h w 3"]
"""Blue, green, red."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ImageFrame:
    """One image of a sequence."""

    frame: int
    stamp_ns: int
    path: Path
    image: Image


@runtime_checkable
class ViewSource(Protocol):
    """Frames that are observed already."""

    def __iter__(self) -> Iterator[View]: ...

    def count(self) -> int:
        """Work to be done, in units of `work`."""
        ...

    def work(self, view: View) -> int:
        """The share of one view in it."""
        ...


@runtime_checkable
class ImageSource(Protocol):
    """Frames that a detector has to look at."""

    def __iter__(self) -> Iterator[ImageFrame]: ...

    def count(self) -> int:
        """Work to be done: the number of images."""
        ...
