# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Draws docs/figures/simulate.png: paths, kinds of noise, a ship in a seaway, and what a detector finds of it.

python docs/figures/simulate.py
"""

from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from fairlead.evaluate.figures import COLOURS
from fairlead.geometry import inverse
from fairlead.simulate import Frames, Noise, Outliers, Scenario, Simulation, load_scenario, simulate
from fairlead.simulate.frames import instants
from fairlead.simulate.streams import Streams

INK, MUTED = "#1b2430", "#6b7686"
PATHS = {
    "arc, 1 km": ("flight-30s", COLOURS["map"], (-650, 640)),
    "rendezvous 10, 20, 30": ("rendezvous-30", COLOURS["refine"], (-2200, 590)),
    "turn at 3 g": ("turn-3g", COLOURS["window"], (-215, 480)),
    "landing": ("landing", COLOURS["epnp"], (-330, 55)),
}
HULL = np.array([[0, 8], [90, 9], [125, 5], [140, 0], [125, -5], [90, -9], [0, -8]])
KINDS = {
    "white": Noise(),
    "alike for 0.5 s": Noise(correlation_time_s=0.5),
    "Student's t, 3 degrees": Noise(tail_dof=3.0),
    "5 % outliers of 6 px that last 0.3 s": Noise(),
}


def paths(axes: Axes) -> None:
    """Seen from above; a dot every 5 s."""
    for label, (name, colour, where) in PATHS.items():
        names = [f"rendezvous-{angle}" for angle in (10, 20, 30)] if name.startswith("rendezvous") else [name]
        for each in names:
            path = load_scenario(each).scenario.trajectory
            c = path.centres(instants(10.0, path.length_s))
            axes.plot(c[:, 0], c[:, 1], color=colour, lw=1.6)
            axes.scatter(c[::50, 0], c[::50, 1], s=9, color=colour, zorder=3)
        axes.text(*where, label, color=colour, fontsize=8.5)
    axes.add_patch(Polygon(HULL, color=INK, lw=0))
    axes.text(170, 0, "ship", fontsize=8.5, color=INK, va="center")
    axes.set(
        xlabel="forward of the stern [m]", ylabel="to port [m]", aspect="equal", xlim=(-2250, 460), ylim=(-860, 860)
    )


def noise(axes: Axes) -> None:
    """One coordinate of one landmark."""
    t = instants(25.0, 12.0)
    camera = load_scenario("arc").scenario.camera
    for row, (seed, (label, kind)) in enumerate(zip((12, 12, 15, 12), KINDS.items(), strict=True)):
        e = kind.draw(t, np.ones((len(t), 1)), Streams(seed))
        if "outliers" in label:
            e = Outliers(share=0.05, size_px=6.0, hold_s=0.3).spoil(e, t, camera, Streams(105))
        offset = -12.0 * row
        axes.axhline(offset, color="0.85", lw=0.7)
        axes.fill_between(t, offset - 1.0, offset + 1.0, color=COLOURS["map"], alpha=0.12, lw=0)
        axes.plot(t, e[:, 0, 0] + offset, color=COLOURS["map"], lw=0.8)
        axes.text(0.0, offset + 7.6, label, fontsize=8.5, va="top")
    axes.plot([12.25, 12.25], [-2.5, 2.5], color=INK, lw=1.4, clip_on=False)
    axes.text(12.45, 0.0, "5 px", fontsize=8.5, va="center", rotation=90)
    axes.set(xlabel="time [s]", yticks=[], xlim=(0, 12), ylim=(-42.5, 8.0))
    axes.spines["left"].set_visible(False)


def seaway(upper: Axes, lower: Axes) -> None:
    """Roll of the ship, and what it does to the camera's position in the frame of the ship."""
    scenario = replace(load_scenario("rolling-ship-5").scenario, frames=Frames(rate_hz=10.0))
    still = replace(scenario, target_motion=type(scenario.target_motion)())
    moving, resting = simulate(scenario, 3), simulate(still, 3)
    t = np.array([view.stamp_ns for view in moving.views]) / 1e9
    roll = [np.degrees(np.arctan2(R[2, 1], R[1, 1])) for R in _turned(moving, resting)]
    upper.plot(t, roll, color=COLOURS["map"], lw=1.6)
    upper.axhline(0.0, color="0.85", lw=0.7, zorder=0)
    upper.set(ylabel="roll [deg]", xlim=(0, 30), ylim=(-6, 6), xticklabels=[])
    moved = _centres(moving) - _centres(resting)
    for column, label, colour in zip(moved.T, ("forward", "to port", "up"), ("window", "epnp", "refine"), strict=True):
        lower.plot(t, column, color=COLOURS[colour], lw=1.6, label=label)
    lower.axhline(0.0, color="0.85", lw=0.7, zorder=0)
    lower.legend(frameon=False, ncols=3, fontsize=8.5, loc="upper center", columnspacing=1.2, handlelength=1.2)
    lower.set(xlabel="time [s]", ylabel="camera moved [m]", xlim=(0, 30), ylim=(-75, 100))


def _turned(moving: Simulation, resting: Simulation) -> list[np.ndarray]:
    """R_world_target: what takes the pose at rest to the moving one."""
    return [(inverse(b) @ a)[:3, :3] for a, b in zip(moving.T_true, resting.T_true, strict=True)]


def _centres(flight: Simulation) -> np.ndarray:
    return np.array([inverse(T)[:3, 3] for T in flight.T_true])


def found(axes: Axes) -> None:
    """Landmark by image of the rough scenario: found, spoilt, hidden or missed, no image."""
    scenario: Scenario = replace(
        load_scenario("rough").scenario, frames=Frames(rate_hz=10.0, drop_share=0.05, drop_s=0.3)
    )
    flight = simulate(scenario, 4)
    names = list(flight.target_true.landmarks)
    state = np.full((len(names), 301), np.nan)
    for view, true in zip(flight.views, flight.views_true, strict=True):
        state[:, view.frame] = 0.0
        exact = dict(zip(true.landmarks, true.pixels, strict=True))
        for name, z in zip(view.landmarks, view.pixels, strict=True):
            state[names.index(name), view.frame] = 2.0 if np.linalg.norm(z - exact[name]) > 12.0 else 1.0
    colours = np.array([[1.0, 1.0, 1.0], [0.68, 0.80, 0.93], [0.78, 0.47, 0.0], [0.87, 0.89, 0.91]])
    image = colours[np.where(np.isnan(state), 3, state).astype(int)]
    axes.imshow(image, aspect="auto", extent=(0, 30, len(names) - 0.5, -0.5), interpolation="nearest")
    axes.set_yticks(range(len(names)), names, fontsize=6.5)
    axes.tick_params(axis="y", length=0)
    axes.set(xlabel="time [s]", ylim=(len(names) - 0.5, -0.5))
    for x, label, colour in (
        (0, "found", colours[1]),
        (4.6, "wrong by 12 px or more", colours[2]),
        (17.0, "no image", colours[3]),
    ):
        axes.scatter(x + 0.3, -1.3, s=42, marker="s", color=colour, clip_on=False)
        axes.text(x + 0.9, -1.3, label, fontsize=8.5, va="center")


def main() -> None:
    """Four parts; the third of two panels."""
    plt.rcParams |= {"font.size": 9, "axes.titlesize": 9.5, "axes.titlelocation": "left", "axes.titleweight": "bold"}
    layout = [["paths", "noise"], ["roll", "found"], ["moved", "found"]]
    figure, panels = plt.subplot_mosaic(
        layout, figsize=(11, 8.4), layout="constrained", width_ratios=(1.1, 1), height_ratios=(2.2, 0.8, 1.3)
    )
    paths(panels["paths"])
    noise(panels["noise"])
    seaway(panels["roll"], panels["moved"])
    found(panels["found"])
    panels["paths"].set_title("Paths, a dot every 5 s")
    panels["noise"].set_title("Kinds of noise: one landmark, the band is 1 sigma")
    panels["roll"].set_title("A ship that rolls by 5 degrees, and the camera in its frame")
    panels["found"].set_title("What is found in the scenario rough", pad=22)
    for axes in panels.values():
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(Path(__file__).with_suffix(".png"), dpi=130)


if __name__ == "__main__":
    main()
