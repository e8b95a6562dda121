# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A long flight: 20,000 frames round the ship, many seeds. Is the model's covariance still true, memory and time flat?

    python -m benchmarks.long_run --seeds 50 -o runs/long

One file per seed; what is done is kept. Writes long_run.md.
"""

import argparse
import json
import multiprocessing
import os
import resource
import sys
import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fairlead.types import Estimate, Points3, Poses, Target

CHECKPOINTS = 40
"""How often the model is judged during a flight."""
SEED = 20_000


def fly(seed: int, frames: int, sigma_px: float, model_sigma_m: float) -> dict[str, list[float]]:
    """One flight with the online tracker; every list has one entry per checkpoint."""
    import numpy as np

    from benchmarks.cells import frigate
    from fairlead.simulate import ModelError, ObservationError, OrbitScenario, orbit_told, orbit_views
    from fairlead.tracker import Tracker

    target, camera = frigate()
    model, noise = ModelError(sigma_m=model_sigma_m), ObservationError(sigma_px=sigma_px)
    scenario = OrbitScenario(frames=frames, model=model, observation=noise)
    rng = np.random.default_rng([SEED, seed])
    tracker = Tracker(orbit_told(target, scenario, rng), camera)
    every = max(1, frames // CHECKPOINTS)
    rows: dict[str, list[float]] = {}
    times, failed = [], 0
    for view in orbit_views(target, camera, scenario, rng):
        start = time.thread_time()  # processor time: other work on the machine does not count
        estimate = tracker.update(view)
        times.append(time.thread_time() - start)
        failed += not estimate.ok
        if (view.frame + 1) % every == 0:
            T_true = scenario.poses(target.positions, np.array([view.frame]))
            row = _accuracy(estimate, tracker.model, T_true, target.positions) | {
                "frame": view.frame + 1,
                "failed_frames": failed,
                "p50_ms": 1e3 * float(np.percentile(times, 50)),
                "p99_ms": 1e3 * float(np.percentile(times, 99)),
                "memory_mib": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
            }
            for key, value in row.items():
                rows.setdefault(key, []).append(float(value))
            times = []
    return rows


def _accuracy(estimate: "Estimate", model: "Target", T_true: "Poses", X_true: "Points3") -> dict[str, float]:
    """Errors and NEES of the newest pose and of the model."""
    import numpy as np

    from benchmarks.scoring import Answer, score

    answer = Answer(
        T=estimate.T_camera_target[None],
        X=model.positions,
        pose_covariances=estimate.covariance[None],
        landmark_covariance=model.covariance,
    )
    scores = score(answer, T_true, X_true)
    return {
        "landmark_nees": scores.landmark_nees,
        "landmark_m": float(scores.landmark_m.mean()),
        "landmark_sigma_m": float(np.sqrt(np.trace(model.covariance) / len(X_true))),
        "pose_nees": float(scores.pose_nees[0]),
        "translation_m": float(scores.translation_m[0]),
    }


def complete(seed: int, folder: Path, frames: int, sigma_px: float, model_sigma_m: float) -> int:
    """Fly this seed unless its file is there."""
    path = folder / f"seed-{seed:03d}.json"
    if not path.exists():
        partial_path = path.with_suffix(".partial")
        partial_path.write_text(json.dumps(fly(seed, frames, sigma_px, model_sigma_m)), encoding="utf-8")
        partial_path.replace(path)
    return seed


def report(folder: Path, seeds: range) -> str:
    """Means over the seeds per checkpoint, the 99.9 % band of the mean NEES, and its drift."""
    import numpy as np
    from scipy.stats import chi2

    flights = [json.loads((folder / f"seed-{seed:03d}.json").read_text(encoding="utf-8")) for seed in seeds]
    table = {key: np.array([flight[key] for flight in flights]) for key in flights[0]}
    count, dof = len(flights), 60
    low, high = chi2.ppf([0.0005, 0.9995], dof * count) / (dof * count)
    nees = table["landmark_nees"] / dof
    x = np.linspace(-0.5, 0.5, nees.shape[1])
    slopes = nees @ x / (x @ x)
    drift, error = slopes.mean(), slopes.std(ddof=1) / np.sqrt(count)
    lines = [
        f"# Long run: {count} flights of {int(table['frame'][0, -1])} frames", "",
        f"The mean landmark NEES / dof has its 99.9 % band at {low:.3f} to {high:.3f} ({dof} x {count} degrees "
        f"of freedom); its drift from the first to the last frame is {drift:+.3f} +- {error:.3f} (1 sigma).", "",
        "| frame | landmark NEES / dof | in band | pose NEES / dof | landmark error m | told m | translation m "
        "| p50 CPU ms | p99 CPU ms | memory MiB | failed frames |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]  # fmt: skip
    for i, mean in enumerate(nees.mean(axis=0)):
        cell = {key: np.nanmean(values[:, i]) for key, values in table.items()}
        lines.append(
            f"| {cell['frame']:.0f} | {mean:.3f} | {'yes' if low <= mean <= high else 'NO'} "
            f"| {cell['pose_nees'] / 6:.2f} "
            f"| {cell['landmark_m']:.3f} | {cell['landmark_sigma_m']:.3f} | {cell['translation_m']:.2f} "
            f"| {cell['p50_ms']:.3f} | {cell['p99_ms']:.3f} | {cell['memory_mib']:.0f} | {cell['failed_frames']:.1f} |"
        )
    return "\n".join(lines) + "\n"


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=50)
    parser.add_argument("--frames", type=int, default=20_000)
    parser.add_argument("--sigma-px", type=float, default=1.0)
    parser.add_argument("--model-sigma-m", type=float, default=1.0)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("-o", "--output", type=Path, required=True)
    options = parser.parse_args(arguments)
    os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")  # before a child loads numpy
    options.output.mkdir(parents=True, exist_ok=True)
    work = partial(
        complete, folder=options.output, frames=options.frames,
        sigma_px=options.sigma_px, model_sigma_m=options.model_sigma_m,
    )  # fmt: skip
    seeds = range(options.seeds)
    with multiprocessing.get_context("spawn").Pool(options.processes) as pool:
        for number, seed in enumerate(pool.imap_unordered(work, seeds), start=1):
            print(f"{number}/{len(seeds)} seed {seed}", file=sys.stderr)
    text = report(options.output, seeds)
    (options.output / "long_run.md").write_text(text, encoding="utf-8")
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
