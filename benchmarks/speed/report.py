# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What was measured, as tables for people and as metrics for the gate."""

import platform
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path
from typing import Any

from benchmarks.metrics import Metric
from benchmarks.speed.programs import BUILD
from benchmarks.speed.window import COST_TOLERANCE, OURS

DEMANDED_RATIO = {"GTSAM": 8.0, "Ceres": 5.0}
"""The window solve is to be so many times faster."""
DEMANDED_UPDATE_MS = {"p50_ms": 0.5, "p99_ms": 2.0}
TIME_TOLERANCE = 0.3
"""Relative change of a time or ratio that is still no regression; times are compared on one machine only."""

Rows = list[dict[str, Any]]


def machine() -> dict[str, str]:
    """What the numbers belong to."""
    cpu = "unknown"
    info = Path("/proc/cpuinfo")
    if info.exists():
        lines = info.read_text(encoding="utf-8").splitlines()
        cpu = next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), cpu)
    ceres = BUILD / "ceres" / "version.txt"
    found = {"cpu": cpu, "system": platform.system(), "python": platform.python_version()}
    for package in ("fairlead", "gtsam", "scipy", "numpy"):
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            found[package] = "-"
    return {**found, "ceres": ceres.read_text(encoding="utf-8") if ceres.exists() else "-"}


def window_lines(rows: Rows) -> Iterator[str]:
    """The table of window solves."""
    yield (
        "| views x landmarks | solver | fastest variant, first damping | iterations | ms per iteration | ms "
        "| times ours (range over turns) | cost above the lowest |"
    )
    yield "|---|---|---|---|---|---|---|---|"
    for r in rows:
        size = f"{r['views']} x {r['landmarks']}" if r["solver"] == OURS else ""
        ratio = f"{r['ratio']:.2g} ({r['ratio_range'][0]:.2g} to {r['ratio_range'][1]:.2g})" if size == "" else "1"
        yield (
            f"| {size} | {r['solver']} | {r['variant']} | {r['iterations']} | {r['ms_per_iteration']:.3f} "
            f"| {r['ms']:.2f} | {ratio} | {max(0.0, r['cost_above_best']):.0e} |"
        )


def update_lines(rows: Rows) -> Iterator[str]:
    """The table of updates."""
    yield "| per frame | frames | p50 [ms] | p99 [ms] | longest [ms] |"
    yield "|---|---|---|---|---|"
    for r in rows:
        yield f"| {r['name']} | {r['frames']} | {r['p50_ms']:.2f} | {r['p99_ms']:.2f} | {r['max_ms']:.2f} |"


def verdicts(windows: Rows, updates: Rows) -> list[tuple[bool, str]]:
    """Each demand: met or not, and with what figure."""
    found = []
    for r in windows:
        size = f"{r['views']} x {r['landmarks']}"
        if r["solver"] in DEMANDED_RATIO:
            wanted = DEMANDED_RATIO[r["solver"]]
            found.append(
                (r["ratio"] >= wanted, f"{size}: {r['ratio']:.1f} x faster than {r['solver']} (wanted {wanted:g})")
            )
        elif r["solver"].startswith(OURS):
            equal = r["cost_above_best"] <= COST_TOLERANCE
            found.append(
                (equal, f"{size}: {r['solver']} ends {max(0.0, r['cost_above_best']):.0e} above the lowest cost")
            )
    for r in (row for row in updates if row["name"].startswith(f"{OURS}, C++")):
        for key, wanted in DEMANDED_UPDATE_MS.items():
            found.append((r[key] <= wanted, f"update(), {r['name']}: {key[:3]} {r[key]:.2f} ms (wanted {wanted:g})"))
    return found


def metrics(windows: Rows, updates: Rows) -> list[Metric]:
    """For the nightly gate on one machine."""
    found = [
        Metric(
            key=f"speed/window/{r['views']}x{r['landmarks']}/{r['solver']}",
            value=r["ms"], unit="ms", better="lower", tolerance=TIME_TOLERANCE,
        )
        for r in windows
    ]  # fmt: skip
    found += [
        Metric(
            key=f"speed/window/{r['views']}x{r['landmarks']}/{r['solver']}/ratio",
            value=r["ratio"], unit="-", better="higher", tolerance=TIME_TOLERANCE,
        )
        for r in windows
        if r["solver"] in DEMANDED_RATIO
    ]  # fmt: skip
    for r in updates:
        for key in DEMANDED_UPDATE_MS:
            name = f"speed/update/{r['name']}/{key[:3]}"
            found.append(Metric(key=name, value=r[key], unit="ms", better="lower", tolerance=TIME_TOLERANCE))
    return found


def markdown(result: dict[str, Any]) -> str:
    """speed.md."""
    about = ", ".join(f"{key} {value}" for key, value in result["machine"].items())
    judged = [
        f"- {'met' if met else '**missed**'}: {text}" for met, text in verdicts(result["windows"], result["updates"])
    ]
    parts = [
        ["# Speed", "", f"One thread, processor time. {about}."],
        ["## Demands", "", *judged],
        ["## Window solve", "", *window_lines(result["windows"])],
        ["## update()", "", *update_lines(result["updates"])],
    ]
    if result["scaling"]:
        views = sorted({int(k) for curve in result["scaling"].values() for k in curve})
        lines = ["| ms per iteration, views | " + " | ".join(map(str, views)) + " |", "|---" * (len(views) + 1) + "|"]
        for label, curve in result["scaling"].items():
            cells = [f"{1e3 * curve[k]:.3g}" if k in curve else "-" for k in views]
            lines.append(f"| {label} | " + " | ".join(cells) + " |")
        parts.append(["## One iteration against the number of views", "", *lines, "", "![scaling](speed_scaling.png)"])
    return "\n\n".join("\n".join(part) for part in parts) + "\n"
