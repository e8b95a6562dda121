# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What a course looked like: loss and held-out errors against crops seen."""

import csv
from pathlib import Path

import numpy as np

LOSSES = ("loss", "map", "distance", "similarity", "covariance", "visibility", "presence")
SHARES = ("within_5_px", "visibility_right", "presence_right", "nees_median")
PANELS = (
    ("loss", tuple(f"train/{part}" for part in LOSSES), "linear"),
    ("held out, visible landmarks [px of the crop]", ("valid/mean_px", "valid/median_px"), "log"),
    (
        "held out",
        ("valid/within_5_px", "valid/visibility_right", "valid/presence_right", "valid/nees_median"),
        "linear",
    ),
)
FILE = "curves.png"


def read_curves(folder: Path) -> dict[str, np.ndarray]:
    """For every quantity (steps, values) (m, 2), the parts of a course one after the other; a later part wins."""
    found: dict[str, dict[int, float]] = {}
    for part in sorted(folder.glob("curves_*/metrics.csv"), key=lambda path: int(path.parent.name.split("_")[1])):
        with part.open(encoding="utf-8", newline="") as stream:
            for row in csv.DictReader(stream):
                for name, cell in row.items():
                    if cell and name not in {"epoch", "step"}:
                        found.setdefault(name, {})[int(row["step"]) + 1] = float(cell)
    return {name: np.array(sorted(values.items())) for name, values in found.items()}


def draw_curves(folder: Path) -> Path | None:
    """Write curves.png beside the checkpoints; None where nothing was logged yet."""
    from matplotlib.figure import Figure

    curves = read_curves(folder)
    if not curves:
        return None
    figure = Figure(figsize=(13.0, 4.0), layout="constrained")
    for axes, (title, names, scale) in zip(figure.subplots(1, len(PANELS)), PANELS, strict=True):
        for name in names:
            if name in curves:
                axes.plot(*curves[name].T, label=name.split("/")[1].replace("_", " "), linewidth=1.5, marker=".")
        axes.set_yscale(scale)
        if "valid/nees_median" in names:
            axes.set_ylim(0.0, 2.0)  # the first epochs are far above, and nobody's concern
        axes.set_title(title, fontsize=10)
        axes.set_xlabel("steps")
        axes.grid(visible=True, alpha=0.3)
        axes.legend(fontsize=8)
    path = folder / FILE
    figure.savefig(path, dpi=110)
    return path
