# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Draws docs/figures/demo.png: the pen of `fairlead demo`, judged on photographs that the refinement has not seen.

python docs/figures/demo.py
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from fairlead.baselines.observed import observed
from fairlead.baselines.single_view import solve_view
from fairlead.evaluate.figures import COLOURS
from fairlead.geometry import project, transform
from fairlead.io.camera import load_camera
from fairlead.io.observations import read_views
from fairlead.io.shipped import shipped_data
from fairlead.io.target import load_target
from fairlead.tracker import LandmarkIndex, refine
from fairlead.types import Camera, Target, View


def residuals(views: list[View], camera: Camera, model: Target) -> np.ndarray:
    """Residuals of every photograph alone with the pose that fits it best, (n, 2) [px]."""
    index = LandmarkIndex(model.landmarks)
    rows = []
    for view in views:
        found = solve_view(observed(view, index), model.positions, camera, refined=True)
        assert not isinstance(found, str), found
        X = model.positions[index(view.landmarks)]
        rows.append(project(camera, transform(found.T_camera_target, X)) - view.pixels)
    return np.concatenate(rows)


def main() -> None:
    """Refine with the even photographs, draw the odd ones."""
    folder = shipped_data("marker_pen")
    target, camera = load_target(folder / "target.toml"), load_camera(folder / "camera.yaml")
    views = list(read_views(folder / "observations.csv"))
    half = refine(views[::2], target, camera).model
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.4), width_ratios=(1, 1.25), layout="constrained")
    for model, label, colour in ((target, "drawing", COLOURS["epnp"]), (half, "refined", COLOURS["refine"])):
        r = residuals(views[1::2], camera, model)
        rms = np.sqrt(np.mean(np.sum(r**2, axis=1)))
        left.scatter(r[:, 0], r[:, 1], s=14, color=colour, alpha=0.8, lw=0, label=f"{label}: {rms:.2f} px rms")
    left.set(xlabel="u residual [px]", ylabel="v residual [px]", aspect="equal", xlim=(-3.2, 3.2), ylim=(-3.2, 3.2))
    left.set_title("8 photographs that the refinement has not seen", fontsize=10, loc="left")
    left.legend(frameon=False, loc="upper left", fontsize=9, handletextpad=0.1)
    moved = 1e3 * (half.positions - target.positions)
    sigma = 1e3 * np.sqrt(np.diag(half.covariance)).reshape(-1, 3)
    told = 1e3 * np.sqrt(np.diag(target.covariance)).reshape(-1, 3)
    order = np.argsort(np.linalg.norm(moved, axis=1))
    rows = np.arange(len(order))
    for axis, marker in zip(range(3), "osD", strict=True):
        right.errorbar(
            rows + 0.22 * (axis - 1),
            moved[order, axis],
            2 * sigma[order, axis],
            fmt=marker,
            ms=3.2,
            lw=0.9,
            color=COLOURS["refine"],
            alpha=(1.0, 0.7, 0.45)[axis],
            label=f"{'xyz'[axis]}, 2 sigma",
        )
    band = 2 * told.mean()
    right.fill_between(rows, -band, band, color=COLOURS["epnp"], alpha=0.15, lw=0, label="told, 2 sigma")
    right.axhline(0.0, color="0.5", lw=0.8)
    right.set(
        xlabel="tag corners, by how far they moved", ylabel="moved from the drawing [mm]", xticks=[], ylim=(-2.4, 2.4)
    )
    right.set_title("what 8 photographs say about the drawing", fontsize=10, loc="left")
    right.legend(frameon=False, ncols=4, fontsize=9, loc="lower left")
    for axes in (left, right):
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(Path(__file__).with_suffix(".png"), dpi=130)


if __name__ == "__main__":
    main()
