# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Every kind of motion prior, told a tenth of, as much as and ten times what is usual, where it may be wrong.

    python -m benchmarks.motion_kinds --runs 16 -o runs/motion_kinds

Translation error of whole simulated flights, rms over frames and flights, and how many times that without a prior.
Writes motion_kinds.md. docs/motion.md.
"""

import argparse
import multiprocessing
import os
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from benchmarks.table import write_table

SEED = 61
SCENARIOS = ("flight-30s", "stop", "turn-3g", "rolling-ship-3", "rolling-ship-5")
DENSITIES_M_S25 = (0.05, 0.5, 5.0)
PRIORS = (("none", 0.5), *((kind, density) for kind in ("range", "target", "world") for density in DENSITIES_M_S25))


def fly(job: tuple[str, int]) -> list[tuple[float, float]]:
    """Of each of PRIORS: mean squared error [m^2], mean NEES / 6; NaN for `world` where nobody tells the attitude."""
    import numpy as np

    from benchmarks.scoring import answer_of, score
    from fairlead.simulate import load_scenario, simulate
    from fairlead.sources.readings import SensorReadings
    from fairlead.tracker import Tracker, TrackerOptions

    name, seed = job
    flight = simulate(load_scenario(name).scenario, [SEED, seed])
    told = replace(flight.target_told, motion=None)  # its own would hold where the options say none
    rows = []
    for kind, density in PRIORS:
        if kind == "world" and not flight.attitudes:
            rows.append((float("nan"), float("nan")))
            continue
        tracker = Tracker(told, flight.camera, TrackerOptions(motion=kind, jerk_density_m_s25=density))
        readings = SensorReadings(ranges=(), attitudes=flight.attitudes if kind == "world" else ())
        found = []
        for view in flight.views:
            readings.tell(tracker, view)
            found.append(tracker.update(view))
        scores = score(answer_of(found, tracker.model), flight.T_true, flight.X_true)
        rows.append((float(np.mean(scores.translation_m**2)), float(np.mean(scores.pose_nees) / 6.0)))
    return rows


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=16, help="flights of each scenario")
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("-o", "--output", type=Path, required=True)
    return parser.parse_args(arguments)


def main(arguments: Sequence[str] | None = None) -> int:
    """Fly, then write the table: rms [m] without a prior, the ratio of the others to it, and NEES / 6."""
    os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
    import numpy as np

    options = parse(arguments)
    jobs = [(name, seed) for name in SCENARIOS for seed in range(options.runs)]
    with multiprocessing.get_context("spawn").Pool(options.processes) as pool:
        flown = np.array(pool.map(fly, jobs, chunksize=1)).reshape(len(SCENARIOS), options.runs, len(PRIORS), 2)
    rms, nees = np.sqrt(flown[..., 0].mean(axis=1)), flown[..., 1].mean(axis=1)
    heads = ("scenario", *(f"{kind}, q {density:g}" if kind != "none" else "none [m]" for kind, density in PRIORS))
    rows = []
    for name, errors, honest in zip(SCENARIOS, rms, nees, strict=True):
        cells = [
            f"{error / errors[0]:.2f} ({value:.1f})".replace("nan (nan)", "")
            for error, value in zip(errors[1:], honest[1:], strict=True)
        ]
        rows.append([name, f"{errors[0]:.1f} ({honest[0]:.1f})", *cells])
    write_table(options.output / "motion_kinds.md", heads, rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
