# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The tables of the demos on stdout."""

import sys

from rich.console import Console
from rich.table import Table

from fairlead.config import DemoConfig
from fairlead.demo.pen import PenResult, demo_pen
from fairlead.demo.ship import DRAWS, SHOWN, ShipResult, demo_ship
from fairlead.progress import ProgressFactory


def show_demo(config: DemoConfig, progress: ProgressFactory) -> None:
    """Run the demo that was asked for and print what came out."""
    if config.recording == "pen":
        show_pen(demo_pen(config))
    else:
        show_ship(demo_ship(config, progress))


def show_ship(result: ShipResult) -> None:
    """EPnP and this project's estimator against the truth."""
    title = f"Frigate, {result.frames} rendered images; means over {DRAWS} rough models"
    table = Table(title=title)
    table.add_column("")
    table.add_column("EPnP", justify="right")
    table.add_column("fairlead", justify="right", style="bold")
    for key, label in SHOWN:
        cells = [result.metrics[name].get(key) for name in ("epnp", "fairlead")]
        table.add_row(label.replace("[", r"\["), *("" if cell is None else f"{cell:.3g}" for cell in cells))
    Console().print(table)
    sys.stdout.write(f"The landmarks of a rough model are {result.landmarks_told_m:.2f} m off (rms).\n")
    sys.stdout.write(f"{result.frames_per_s:.0f} images a second, from the video to the pose.\n")
    sys.stdout.write(f"{result.overlay}\n{result.report} ({result.seconds:.1f} s)\n")


def show_pen(result: PenResult) -> None:
    """Drawing against refined model."""
    drawn, refined = result.drawing_side, result.refined_side
    table = Table(title=f"Pen with eight tags: {result.photographs} photographs, {result.corners} corners")
    table.add_column("")
    table.add_column("drawing", justify="right")
    table.add_column("refined", justify="right", style="bold")
    table.add_row(r"reprojection \[px rms]", f"{result.drawing_px:.2f}", f"{result.refined_px:.2f}")
    unseen = "  on odd photographs, refined with the even"
    table.add_row(unseen, f"{result.drawing_unseen_px:.2f}", f"{result.refined_unseen_px:.2f}")
    refined_mm = f"{refined.mean_mm:.2f} ± {refined.sigma_mm:.2f}"
    table.add_row(r"mean side of the tags \[mm]", f"{drawn.mean_mm:.2f} ± {drawn.sigma_mm:.2f}", refined_mm)
    Console().print(table)
    sys.stdout.write("Photographs do not tell the scale: it is that of the drawing as a whole.\n")
    sys.stdout.write(f"{result.report} ({result.seconds:.1f} s)\n")
