# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Draw docs/figures/motion.png: what a motion prior and a range finder buy, over time.

python docs/figures/motion.py
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from fairlead.io.camera import load_camera
from fairlead.io.target import load_target
from fairlead.simulate import ArcScenario, ModelError, ObservationError, Simulation, simulate_arc
from fairlead.tracker import Tracker, TrackerOptions

ROOT = Path(__file__).resolve().parents[2]
FLIGHTS = 8
SIGMA_PX = 4.0
SCENARIO = ArcScenario(
    angle_deg=90.0,
    views=751,
    interval_s=0.04,
    model=ModelError(sigma_m=1.0),
    observation=ObservationError(sigma_px=SIGMA_PX),
)
CURVES = {
    "single views": (TrackerOptions(), False, "#d55e00"),
    'motion "range"': (TrackerOptions(motion="range"), False, "#0072b2"),
    'motion "range", a range reading a second': (TrackerOptions(motion="range", range_to_origin=True), True, "#009e73"),
}


def squares(flight: Simulation, options: TrackerOptions, rng: np.random.Generator | None) -> np.ndarray:
    """Squared translation error of every frame [m^2]."""
    tracker = Tracker(flight.target_told, flight.camera, options)
    found = []
    for view, T in zip(flight.views, flight.T_true, strict=True):
        if rng is not None and view.frame % 25 == 0:
            tracker.add_range(view.stamp_ns, float(np.linalg.norm(T[:3, 3]) + 0.5 * rng.standard_normal()), 0.5)
        found.append(np.sum((tracker.update(view).T_camera_target[:3, 3] - T[:3, 3]) ** 2))
    return np.array(found)


def main() -> None:
    """Fly, and draw the rms over the flights."""
    target = load_target(ROOT / "data" / "frigate" / "target.toml")
    camera = load_camera(ROOT / "data" / "frigate" / "camera.yaml")
    flights = [simulate_arc(target, camera, SCENARIO, np.random.default_rng([11, s])) for s in range(FLIGHTS)]
    time_s = np.arange(SCENARIO.views) * SCENARIO.interval_s
    figure, axes = plt.subplots(figsize=(7.6, 3.6), layout="constrained")
    for label, (options, ranged, colour) in CURVES.items():
        runs = [squares(f, options, np.random.default_rng([12, s]) if ranged else None) for s, f in enumerate(flights)]
        rms = np.sqrt(np.mean(runs, axis=0))
        axes.semilogy(time_s, rms, color=colour, lw=1.6, label=label)
    axes.set(
        xlabel="time [s]", ylabel="translation error [m rms]", xlim=(0, time_s[-1]), ylim=(0.5, 300),
        title=f"Frigate at 1 km, 90 degrees in 30 s, {SIGMA_PX:g} px, model 1 m off, {FLIGHTS} flights",
    )  # fmt: skip
    axes.grid(visible=True, which="both", alpha=0.25)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, ncols=3, loc="upper center", fontsize=8.5)
    figure.savefig(Path(__file__).with_suffix(".png"), dpi=140)


if __name__ == "__main__":
    main()
