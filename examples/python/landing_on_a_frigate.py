# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""An aircraft flies a quarter circle of 1 km about a frigate; the plan of the ship that it carries is a metre off.

The tracker gets the rough plan and the noisy landmarks of each image. Printed: how far off the ship's position is, what
the covariance says of it, and how wrong the ship's shape is by then. `landing_on_a_frigate.py OUT` keeps the plan.
"""

import sys
from pathlib import Path

import numpy as np

import fairlead as fl
from fairlead.geometry import align_similarity
from fairlead.simulate import ArcScenario, ModelError, ObservationError, simulate_arc

DATA = Path(__file__).resolve().parents[2] / "data" / "frigate"


def shape_error(positions: np.ndarray, positions_true: np.ndarray) -> float:
    """Rms landmark error [m] when position, attitude and size, which no image shows, are taken off."""
    aligned = align_similarity(positions_true, positions).apply(positions)
    return float(np.sqrt(((aligned - positions_true) ** 2).sum(axis=1).mean()))


def main() -> int:
    noise = ObservationError(sigma_px=0.3)
    scenario = ArcScenario(views=120, interval_s=0.25, model=ModelError(sigma_m=1.0), observation=noise)
    target, camera = fl.load_target(DATA / "target.toml"), fl.load_camera(DATA / "camera.yaml")
    flight = simulate_arc(target, camera, scenario, np.random.default_rng(1))

    tracker = fl.Tracker(flight.target_told, camera)
    print(f"told:      shape {shape_error(flight.target_told.positions, flight.X_true):.2f} m rms")
    for view, T_true in zip(flight.views, flight.T_true, strict=True):
        estimate = tracker.update(view)
        if estimate.ok and view.frame % 20 == 19:
            T = estimate.T_camera_target
            error_m = np.linalg.norm(T[:3, 3] - T_true[:3, 3])
            sigma_m = np.sqrt(np.trace(estimate.covariance[:3, :3]))
            shape_m = shape_error(tracker.model.positions, flight.X_true)
            pose = f"error {error_m:5.2f} m, 1 sigma {sigma_m:5.2f} m"
            print(f"view {view.frame + 1:3d}:  {pose}; shape {shape_m:.2f} m rms")
    if len(sys.argv) > 1:
        fl.save_target(Path(sys.argv[1]) / "target_refined.toml", tracker.model)
    return 0


if __name__ == "__main__":
    sys.exit(main())
