# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What every sink is."""

from typing import Protocol, runtime_checkable

from fairlead.types import Estimate


@runtime_checkable
class Sink(Protocol):
    """Takes the estimates one after another. Raises OSError where they cannot be written."""

    def write(self, estimate: Estimate) -> None:
        """Take one estimate."""
        ...

    def close(self) -> None:
        """Finish; safe to call twice."""
        ...
