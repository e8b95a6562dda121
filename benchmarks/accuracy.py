# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The deterministic part of the grid that gates every change: few cells, fixed seeds, well below a minute."""

import numpy as np

from benchmarks.cells import Cell, run_cell
from benchmarks.metrics import Metric
from benchmarks.verdicts import ERRORS, failures, normalised_nees, per_run

WORKLOADS: tuple[tuple[str, Cell], ...] = (
    ("clean", Cell(sigma_px=0.25, angle_deg=5.0, model_sigma_m=1.0)),
    ("clean", Cell(sigma_px=1.0, angle_deg=5.0, model_sigma_m=3.0)),
    ("clean", Cell(sigma_px=1.0, angle_deg=90.0, model_sigma_m=1.0)),
    ("clean", Cell(sigma_px=4.0, angle_deg=180.0, model_sigma_m=1.0)),
    ("clean", Cell(sigma_px=8.0, angle_deg=60.0, model_sigma_m=0.5)),
    ("outliers-10", Cell(sigma_px=1.0, angle_deg=90.0, model_sigma_m=1.0)),
    ("outliers-30", Cell(sigma_px=1.0, angle_deg=90.0, model_sigma_m=1.0)),
)
RUNS = 20
UNITS = {"rotation_deg": "deg", "translation_m": "m", "landmark_m": "m"}
TOLERANCE = 0.02
"""Same seeds give the same digits on one machine; another compiler moves single flights by less than this."""


def measure() -> list[Metric]:
    """Mean errors of every method, and NEES per degree of freedom and failures of `map`."""
    metrics: list[Metric] = []
    for data, cell in WORKLOADS:
        scores = run_cell(cell, data, RUNS, ["epnp", "window", "map"])
        for name, table in scores.items():
            head = f"accuracy/{data}/{cell.name}/{name}"
            for key in ERRORS:
                better = "lower" if name == "map" else "same"
                value = float(np.mean(per_run(table, key)))
                metrics.append(
                    Metric(key=f"{head}/{key}", value=value, unit=UNITS[key], better=better, tolerance=TOLERANCE)
                )
        head, table = f"accuracy/{data}/{cell.name}/map", scores["map"]
        for key in ("pose_nees", "landmark_nees"):
            value, _ = normalised_nees(table, key)
            metrics.append(Metric(key=f"{head}/{key}", value=value, unit="-", better="same", tolerance=TOLERANCE))
        metrics.append(
            Metric(key=f"{head}/failures", value=failures(table), unit="-", better="lower", tolerance=TOLERANCE)
        )
    return metrics
