# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Time of one iteration against the number of views, and the figure of it."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.speed.problem import make_problem
from benchmarks.speed.solver import Settings, Solver

VIEWS = (10, 16, 32, 64, 128, 256, 512, 1024)
LANDMARKS = 20
ITERATIONS = 4
"""Of every solve: nobody stops earlier."""
LIMIT_S = 3.0
"""A curve ends where one solve takes longer."""
ROUNDS = 7

CURVES = {
    "fairlead": ("fairlead", "-"),
    "Ceres, poses first": ("Ceres", "poses-eigen"),
    "Ceres, landmarks first": ("Ceres", "landmarks-eigen"),
    "GTSAM, poses first": ("GTSAM", "poses/MULTIFRONTAL_CHOLESKY/identity"),
    "SciPy, sparse": ("SciPy", "trf-lsmr"),
}


def measure_scaling(
    solvers: Mapping[str, Solver], say: Callable[[str], None], views: tuple[int, ...] = VIEWS
) -> dict[str, dict[int, float]]:
    """Processor seconds of one iteration, {curve: {views: seconds}}: solvers in turns, the quickest turn of each."""
    curves = {label: curve for label, curve in CURVES.items() if curve[0] in solvers}
    found: dict[str, dict[int, float]] = {label: {} for label in curves}
    running = dict(curves)
    for k in views:
        say(f"{k} views: {', '.join(running)}")
        problem = make_problem(k, LANDMARKS)
        for name in {name for name, _ in running.values()}:
            solvers[name].prepare(problem)
        spent: dict[str, list[float]] = {label: [] for label in running}
        for _ in range(ROUNDS):
            for label, (name, variant) in running.items():
                if spent[label] and spent[label][0] * ITERATIONS > 0.3 * LIMIT_S:
                    continue  # slow: once is enough
                settings = Settings(variant=variant, max_iterations=ITERATIONS, tolerance=0.0)
                seconds, iterations = solvers[name].solve(settings, 0.01)
                spent[label].append(seconds / iterations)
        for label, seconds in spent.items():
            found[label][k] = min(seconds)
            if found[label][k] * ITERATIONS > 0.3 * LIMIT_S:
                del running[label]
    return found


def linear_fit(curve: Mapping[int, float]) -> tuple[float, float, float]:
    """t = a + b k by least relative squares: a [s], b [s per view], largest relative deviation [-]."""
    k = np.array(list(curve), dtype=np.float64)
    t = np.array(list(curve.values()))
    (a, b), *_ = np.linalg.lstsq(np.stack([1.0 / t, k / t], axis=1), np.ones_like(t), rcond=None)
    return float(a), float(b), float(np.abs((a + b * k) / t - 1.0).max())


COLOURS = {
    "fairlead": "#0072b2",
    "Ceres, poses first": "#d55e00",
    "Ceres, landmarks first": "#e69f00",
    "GTSAM, poses first": "#009e73",
    "SciPy, sparse": "#888888",
}


def spread(heights: list[float], gap: float) -> list[float]:
    """The same heights moved apart, as little as is needed for `gap` between neighbours."""
    order = np.argsort(heights)
    moved = np.array(heights, dtype=np.float64)[order]
    for _ in range(100):
        for i in range(len(moved) - 1):
            short = gap - (moved[i + 1] - moved[i])
            if short > 0.0:
                moved[[i, i + 1]] += [-0.5 * short, 0.5 * short]
    found = np.empty(len(moved))
    found[order] = moved
    return [float(height) for height in found]


def _left(axes: Any, curves: Mapping[str, Mapping[int, float]]) -> None:
    for label, curve in curves.items():
        ours = label == "fairlead"
        k, ms = np.array(list(curve)), 1e3 * np.array(list(curve.values()))
        width, size, above = (2.4, 5, 3) if ours else (1.5, 4, 2)
        axes.loglog(k, ms, "o-", color=COLOURS[label], lw=width, ms=size, zorder=above)
    ends = [1e3 * list(curve.values())[-1] for curve in curves.values()]
    for label, curve, height in zip(curves, curves.values(), spread(list(np.log10(ends)), 0.23), strict=True):
        axes.annotate(
            label, (max(curve), 10.0**height), xytext=(9, 0), textcoords="offset points", color=COLOURS[label],
            va="center", fontweight="bold" if label == "fairlead" else "normal", annotation_clip=False,
        )  # fmt: skip
    axes.set(xlabel="views in the window", ylabel="processor time of one iteration [ms]")
    axes.set_title("Time of one iteration, 20 landmarks", loc="left")


def _right(axes: Any, curve: Mapping[int, float]) -> None:
    a, b, deviation = linear_fit(curve)
    k, ms = np.array(list(curve)), 1e3 * np.array(list(curve.values()))
    line = np.array([0, k.max()])
    axes.plot(line, 1e3 * (a + b * line), color="#bbbbbb", lw=6, solid_capstyle="butt", zorder=1)
    axes.plot(k, ms, "o", color=COLOURS["fairlead"], ms=6, zorder=2)
    axes.annotate(
        f"{1e6 * b:.2f} µs per view + {1e6 * a:.0f} µs\nall points within {100 * deviation:.0f} %",
        (0.06, 0.92), xycoords="axes fraction", va="top", bbox={"color": "white", "pad": 2},
    )  # fmt: skip
    axes.set(
        xlabel="views in the window", ylabel="processor time of one iteration [ms]", xlim=(0, None), ylim=(0, None)
    )
    axes.set_title("fairlead on linear axes", loc="left")


def draw(curves: Mapping[str, Mapping[int, float]], path: Path) -> None:
    """Left: everybody, both axes logarithmic. Right: ours on linear axes with the straight line through it."""
    import matplotlib.pyplot as plt
    from matplotlib.ticker import NullLocator, ScalarFormatter

    style = {"font.size": 10, "axes.titlesize": 11, "axes.spines.top": False, "axes.spines.right": False}
    with plt.rc_context(style):
        figure, (left, right) = plt.subplots(
            1, 2, figsize=(10.4, 4.4), width_ratios=(1.25, 1), gridspec_kw={"wspace": 0.62}
        )
        _left(left, curves)
        _right(right, curves["fairlead"])
        left.set_xticks(VIEWS)
        left.xaxis.set_major_formatter(ScalarFormatter())
        left.xaxis.set_minor_locator(NullLocator())
        left.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
        for axes in (left, right):
            axes.grid(color="#e6e6e6", lw=0.8)
            axes.set_axisbelow(True)
        figure.savefig(path, dpi=150, bbox_inches="tight")
        plt.close(figure)
