# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A flight of 30 s, 25 frames a second, tracked online: how near the causal bound, is the covariance true?

    python -m benchmarks.flight --runs 16 -o runs/flight
    python -m benchmarks.flight --runs 16 --motion range --sigmas 2 --correlation-time-s 0.5 -o runs/flight
    python -m benchmarks.flight --runs 16 --motion range --range-sigma-m 0.5 --range-outliers 0.1 -o runs/flight

90 degrees of arc at 1 km round the still frigate, model error 1 m. One file per noise, motion and run; what is done is
kept. Writes flight.md. docs/motion.md.
"""

import argparse
import json
import multiprocessing
import os
import sys
from collections.abc import Sequence
from functools import lru_cache, partial
from pathlib import Path
from typing import TYPE_CHECKING

from benchmarks.table import write_table

if TYPE_CHECKING:
    from fairlead.simulate import Simulation

SEED = 30_025
FRAMES = 750
INTERVAL_S = 0.04
DENSITY_M_S25 = 0.5
MOTIONS = ("none", "range", "target", "world")
ATTITUDE_SIGMA_RAD = 3.5e-3
FRAMES_A_READING = 25
RANGE_OUTLIER_M = 50.0
HEADINGS = ("px", "motion", "runs", "rms [m]", "rms / bound", "at 15 s", "last 2 s", "NEES / 6", "true model, PnP [m]")


def simulated(seed: int, sigma_px: float, correlation_time_s: float) -> "Simulation":
    """White noise, or noise that is alike in neighbouring frames: e_k = a e_(k-1) + sqrt(1 - a^2) w_k."""
    from dataclasses import replace

    import numpy as np

    from benchmarks.cells import frigate
    from fairlead.simulate import ArcScenario, ModelError, ObservationError, simulate_arc
    from fairlead.simulate.truth import project_all

    target, camera = frigate()
    scenario = ArcScenario(
        views=FRAMES,
        interval_s=INTERVAL_S,
        model=ModelError(sigma_m=1.0),
        observation=ObservationError(sigma_px=sigma_px),
    )
    flight = simulate_arc(target, camera, scenario, np.random.default_rng([SEED, round(100 * sigma_px), seed]))
    if not correlation_time_s > 0.0:
        return flight
    alike = np.exp(-INTERVAL_S / correlation_time_s)
    exact = project_all(camera, target.positions, flight.T_true)
    noise = np.stack([view.pixels for view in flight.views]) - exact
    for k in range(1, len(noise)):
        noise[k] = alike * noise[k - 1] + np.sqrt(1.0 - alike**2) * noise[k]
    views = tuple(replace(view, pixels=z) for view, z in zip(flight.views, exact + noise, strict=True))
    return replace(flight, views=views)


def fly(seed: int, sigma_px: float, motion: str, told: argparse.Namespace) -> dict[str, list[float]]:
    """Squared translation error [m^2], NEES of every pose, squared error of PnP with the true model."""
    import numpy as np

    from benchmarks.scoring import answer_of, score
    from fairlead.tracker import Tracker, TrackerOptions

    flight = simulated(seed, sigma_px, told.correlation_time_s)
    options = TrackerOptions(
        motion=motion,
        jerk_density_m_s25=told.density,
        correlation_time_s=told.correlation_time_s,
        range_to_origin=told.range_sigma_m > 0.0,
    )
    tracker = Tracker(flight.target_told, flight.camera, options)
    rng = np.random.default_rng([SEED, 1, seed])
    found = []
    for view, T in zip(flight.views, flight.T_true, strict=True):
        if motion == "world":
            R = T[:3, :3].T @ _small_rotation(ATTITUDE_SIGMA_RAD * rng.standard_normal(3))
            tracker.add_attitude(view.stamp_ns, R, ATTITUDE_SIGMA_RAD)
        if told.range_sigma_m > 0.0 and view.frame % FRAMES_A_READING == 0:
            wrong_m = RANGE_OUTLIER_M * rng.choice([-1.0, 1.0]) if rng.random() < told.range_outliers else 0.0
            reading_m = float(np.linalg.norm(T[:3, 3]) + told.range_sigma_m * rng.standard_normal() + wrong_m)
            tracker.add_range(view.stamp_ns, reading_m, told.range_sigma_m)
        found.append(tracker.update(view))
    scores = score(answer_of(found, tracker.model), flight.T_true, flight.X_true)
    return {
        "squares": list(scores.translation_m**2),
        "nees": list(scores.pose_nees),
        "landmark_nees": [scores.landmark_nees / (3 * len(flight.X_true))],
        "true_model": _true_model(flight),
    }


def _small_rotation(phi: "object") -> "object":
    from scipy.spatial.transform import Rotation

    return Rotation.from_rotvec(phi).as_matrix()


def _true_model(flight: "Simulation") -> list[float]:
    """Squared translation error of PnP frame by frame with the true model, second half [m^2]."""
    import numpy as np

    from fairlead.baselines.observed import observed
    from fairlead.baselines.single_view import SingleView, solve_view
    from fairlead.tracker import LandmarkIndex

    squares, index = [], LandmarkIndex(flight.target_true.landmarks)
    for view, T in list(zip(flight.views, flight.T_true, strict=True))[FRAMES // 2 :: 5]:
        solved = solve_view(observed(view, index), flight.X_true, flight.camera, refined=True)
        if not isinstance(solved, SingleView):
            raise RuntimeError(f"no pose from the true model in frame {view.frame}")
        squares.append(float(np.sum((solved.T_camera_target[:3, 3] - T[:3, 3]) ** 2)))
    return squares


@lru_cache
def bound(sigma_px: float, density: float) -> list[float]:
    """Causal bound of kind `target` [m^2], docs/bound.md eq. (19)."""
    import numpy as np

    from reference.cameras import make_projection
    from reference.motion_bound import causal_translation_bound

    flight = simulated(0, sigma_px, 0.0)
    camera = flight.camera
    return list(
        causal_translation_bound(
            make_projection(camera.model, camera.K, camera.distortion),
            flight.X_true, np.eye(3 * len(flight.X_true)), flight.T_true,
            np.array([1e-9 * view.stamp_ns for view in flight.views]), sigma_px**2 * np.eye(2), density,
        )
    )  # fmt: skip


def _file(folder: Path, job: tuple[int, float, str], options: argparse.Namespace) -> Path:
    seed, sigma_px, motion = job
    kind = f"s{sigma_px:g}-{motion}-q{options.density:g}-tau{options.correlation_time_s:g}"
    if options.range_sigma_m > 0.0:
        kind += f"-r{options.range_sigma_m:g}-{options.range_outliers:g}"
    return folder / kind / f"{seed}.json"


def _complete(job: tuple[int, float, str], options: argparse.Namespace) -> str:
    path = _file(options.output, job, options)
    if not path.exists():
        seed, sigma_px, motion = job
        row = fly(seed, sigma_px, motion, options)
        path.parent.mkdir(parents=True, exist_ok=True)
        partial_file = path.with_suffix(f".{os.getpid()}.partial")
        partial_file.write_text(json.dumps(row), encoding="utf-8")
        partial_file.replace(path)
    return f"{path.parent.name} {job[0]}"


def _row(sigma_px: float, motion: str, options: argparse.Namespace) -> list[str]:
    """Of the table: second half of the flight, all runs."""
    import numpy as np

    files = [_file(options.output, (seed, sigma_px, motion), options) for seed in range(options.runs)]
    rows = [json.loads(path.read_text(encoding="utf-8")) for path in files]
    squares = np.array([row["squares"] for row in rows])
    nees = np.array([row["nees"] for row in rows])[:, FRAMES // 2 :] / 6.0
    true_model = np.array([row["true_model"] for row in rows])
    floor = np.array(bound(sigma_px, options.density))
    parts = [slice(FRAMES // 2, FRAMES), slice(FRAMES // 2, FRAMES // 2 + 10), slice(FRAMES - 50, FRAMES)]
    ratios = [float(np.sqrt(squares[:, part].mean() / floor[part].mean())) for part in parts]
    per_flight = nees.mean(axis=1)
    error = per_flight.std(ddof=1) / np.sqrt(len(per_flight)) if len(per_flight) > 1 else float("nan")
    return [
        f"{sigma_px:g}", motion, f"{len(rows)}", f"{np.sqrt(squares[:, parts[0]].mean()):.1f}",
        *(f"{ratio:.2f}" for ratio in ratios),
        f"{per_flight.mean():.2f} ± {error:.2f}", f"{np.sqrt(true_model.mean()):.1f}",
    ]  # fmt: skip


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=16, help="flights per noise and motion")
    parser.add_argument("--sigmas", type=float, nargs="+", default=[1.0, 2.0, 4.0], help="noise [px]")
    parser.add_argument("--motion", nargs="+", choices=MOTIONS, default=["range", "target"])
    parser.add_argument("--density", type=float, default=DENSITY_M_S25, help="told, of the jerk [m/s^2.5]")
    parser.add_argument("--correlation-time-s", type=float, default=0.0, help="of the noise, and told [s]")
    parser.add_argument("--range-sigma-m", type=float, default=0.0, help="a reading a second to the origin; 0: none")
    parser.add_argument("--range-outliers", type=float, default=0.0, help="share of the readings that is 50 m off")
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("-o", "--output", type=Path, required=True)
    return parser.parse_args(arguments)


def main(arguments: Sequence[str] | None = None) -> int:
    """Fly what is missing, then write the table."""
    os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
    options = parse(arguments)
    jobs = [(s, px, m) for px in options.sigmas for m in options.motion for s in range(options.runs)]
    with multiprocessing.get_context("spawn").Pool(options.processes) as pool:
        for text in pool.imap(partial(_complete, options=options), jobs):
            print(text, file=sys.stderr)
    rows = [_row(px, motion, options) for px in options.sigmas for motion in options.motion]
    write_table(options.output / "flight.md", HEADINGS, rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
