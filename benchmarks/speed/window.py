# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The table of window solves: who takes part, in which variants, in turns, and whether all found the same optimum."""

import statistics
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from benchmarks.speed.problem import WindowProblem, make_problem
from benchmarks.speed.solver import Settings, Solver

SIZES = ((10, 20), (64, 20), (256, 20), (64, 100))
"""Views x landmarks."""
ROUNDS = 11
BURST_S = 0.02
"""A solver repeats its solve for this long when it is its turn, so that its code and data are in the caches."""
COST_TOLERANCE = 2e-9
"""Relative difference of final costs that counts as equal: what the common stopping rule leaves open."""
OURS = "fairlead"

DAMPINGS = (1e-4, 1e-5, 1e-6)
"""First dampings that everybody may choose from."""

_D = Settings()
CORE = tuple(replace(_D, damping=damping) for damping in DAMPINGS)
CERES = tuple(
    replace(_D, variant=variant, damping=damping)
    for variant in ("poses-eigen", "poses-lapack", "landmarks-eigen", "landmarks-lapack", "sparse")
    for damping in DAMPINGS
)
GTSAM = (
    *(
        replace(_D, variant=f"{ordering}/MULTIFRONTAL_CHOLESKY/identity", damping=damping)
        for ordering in ("poses", "landmarks", "COLAMD", "METIS")
        for damping in DAMPINGS
    ),
    *(replace(_D, variant="poses/MULTIFRONTAL_CHOLESKY/diagonal", damping=damping) for damping in DAMPINGS),
    replace(_D, variant="poses/SEQUENTIAL_CHOLESKY/identity"),
    replace(_D, variant="poses/MULTIFRONTAL_SOLVER/identity"),
)
SCIPY = (replace(_D, variant="trf-lsmr"), replace(_D, variant="lm"))


def candidates(name: str, problem: WindowProblem) -> tuple[Settings, ...]:
    """What is tried of a solver; what would take a peer minutes is left out."""
    if name.startswith(OURS):
        return CORE
    if name == "Ceres":
        return CERES
    many_views = problem.views > 128
    if name == "GTSAM":
        return tuple(s for s in GTSAM if not (many_views and s.variant.startswith("landmarks")))
    return SCIPY[:1] if problem.views > 16 else SCIPY


@dataclass(frozen=True, kw_only=True)
class Timing:
    """One solver on one problem."""

    name: str
    settings: Settings
    iterations: int
    seconds: tuple[float, ...]
    """Of one solve, for each round."""
    cost: float
    """E where it ended, by the one function that judges all."""
    tried: dict[str, float]
    """Seconds of every variant in the qualification."""

    @property
    def median_s(self) -> float:
        return statistics.median(self.seconds)


def label(settings: Settings) -> str:
    """Variant and first damping, as far as there is something to say."""
    variant = "" if settings.variant == "-" else settings.variant.replace("/", ", ").lower()
    damping = "" if settings in SCIPY else f"{settings.damping:.0e}"
    return ", ".join(part for part in (variant, damping) if part)


def fastest(solver: Solver, tried: tuple[Settings, ...]) -> tuple[Settings, dict[str, float]]:
    """The quickest of the variants, and the seconds of each."""
    seconds = {s: solver.solve(s, 0.0 if len(tried) == 1 else BURST_S)[0] for s in tried}
    return min(seconds, key=seconds.__getitem__), {f"{s.variant} {s.damping:g}": t for s, t in seconds.items()}


def race(
    problem: WindowProblem, solvers: Mapping[str, Solver], rounds: int, say: Callable[[str], None]
) -> list[Timing]:
    """All solvers in turns, `rounds` times, each in its fastest variant."""
    chosen: dict[str, Settings] = {}
    tried: dict[str, dict[str, float]] = {}
    for name, solver in solvers.items():
        solver.prepare(problem)
        chosen[name], tried[name] = fastest(solver, candidates(name, problem))
        say(f"  {name}: {label(chosen[name])}")
    seconds: dict[str, list[float]] = {name: [] for name in solvers}
    iterations: dict[str, int] = {}
    for turn in range(rounds):
        for name, solver in solvers.items():
            if name == "SciPy" and turn >= 3:
                continue  # a hundred times slower: three turns say enough
            spent, iterations[name] = solver.solve(chosen[name], BURST_S)
            seconds[name].append(spent)
    found = []
    for name, solver in solvers.items():
        answer = solver.answer()
        found.append(
            Timing(
                name=name,
                settings=chosen[name],
                iterations=iterations[name],
                seconds=tuple(seconds[name]),
                cost=problem.cost(answer.X, answer.T),
                tried=tried[name],
            )
        )
    return found


def row(size: tuple[int, int], timing: Timing, ours: Timing, best_cost: float) -> dict[str, Any]:
    """One line of the table. The ratio is the median over rounds of the ratio within a round."""
    ratios = [theirs / mine for theirs, mine in zip(timing.seconds, ours.seconds, strict=False)]
    return {
        "views": size[0],
        "landmarks": size[1],
        "solver": timing.name,
        "variant": label(timing.settings),
        "iterations": timing.iterations,
        "ms": 1e3 * timing.median_s,
        "ms_per_iteration": 1e3 * timing.median_s / timing.iterations,
        "ratio": statistics.median(ratios),
        "ratio_range": [min(ratios), max(ratios)],
        "cost": timing.cost,
        "cost_above_best": timing.cost / best_cost - 1.0,
        "tried_ms": {variant: 1e3 * seconds for variant, seconds in timing.tried.items()},
    }


def measure_windows(
    solvers: Mapping[str, Solver], say: Callable[[str], None], rounds: int = ROUNDS
) -> list[dict[str, Any]]:
    """Rows of the table, ours first within each size. The ratio is to the first solver: the core's portable build."""
    rows = []
    for size in SIZES:
        say(f"window of {size[0]} views x {size[1]} landmarks")
        timings = race(make_problem(*size), solvers, rounds, say)
        best = min(timing.cost for timing in timings)
        rows += [row(size, timing, timings[0], best) for timing in timings]
    return rows
