# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What every sink is."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import UInt8

from fairlead.types import Estimate, View


@runtime_checkable
class Sink(Protocol):
    """Takes the estimates one after another. Raises OSError where they cannot be written."""

    def write(self, estimate: Estimate) -> None:
        """Take one estimate."""
        ...

    def close(self) -> None:
        """Finish; safe to call twice."""
        ...


@dataclass(frozen=True, kw_only=True, eq=False)
class Outcome:
    """All there is about one frame."""

    estimate: Estimate
    view: View
    image: UInt8[np.ndarray, "h w 3"] | None = None
    """What the camera saw, blue, green, red; None where the source has no images."""


@runtime_checkable
class OutcomeSink(Protocol):
    """Takes everything about the frames, one after another. Raises OSError where it cannot be written."""

    def write(self, outcome: Outcome) -> None:
        """Take one frame."""
        ...

    def close(self) -> None:
        """Finish; safe to call twice."""
        ...
