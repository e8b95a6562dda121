# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What the benchmark asks of every solver, ours and the peers'."""

from dataclasses import dataclass
from typing import Protocol

from benchmarks.speed.problem import WindowProblem
from fairlead.types import Points3, Poses


@dataclass(frozen=True, kw_only=True)
class Settings:
    """How to solve. A solver without one of these says so."""

    variant: str = "-"
    """Ordering, factorisation and the like; each solver has its own."""
    max_iterations: int = 50
    damping: float = 1e-6
    """Of the first step: lambda in H + lambda diag(H)."""
    tolerance: float = 1e-9
    """Relative decrease of the cost at which the iterations end."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Answer:
    """Where a solver ended."""

    X: Points3
    T: Poses


class Solver(Protocol):
    """A solver that can be timed."""

    def prepare(self, problem: WindowProblem) -> None:
        """Take the problem in; not timed."""
        ...

    def solve(self, settings: Settings, seconds: float) -> tuple[float, int]:
        """Solve from the start again and again until `seconds` of processor time are spent, once at least.

        Returns
        -------
        processor seconds of one solve, on average, and its iterations (linear systems solved).
        """
        ...

    def answer(self) -> Answer:
        """Where the last solve ended."""
        ...
