# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The landing with a range finder that always reads too much: what it costs, and whether it is found. docs/range.md.

python -m benchmarks.range_bias --runs 24 -o runs/range_bias
"""

import argparse
import multiprocessing
import os
import sys
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from benchmarks.table import write_table

SEED = 51
BIAS_SIGMA_M = 3.0
HEADINGS = ("range finder", "rms [m]", "rms, hover [m]", "NEES / 6", "bias, error rms [m]", "sigma told [m]", "NEES")
HOVER_S = 10.0
TOLD = {"none": (False, 0.0), "taken as right": (True, 0.0), "bias estimated": (True, BIAS_SIGMA_M)}


def fly(seed: int, rate_hz: float) -> dict[str, list[float]]:
    """Of each of TOLD: squared errors [m^2] of the flight and of the hover, NEES, error of the bias, its sigma."""
    import numpy as np

    from benchmarks.scoring import answer_of, score
    from fairlead.simulate import load_scenario, simulate
    from fairlead.sources.readings import SensorReadings
    from fairlead.tracker import Tracker, TrackerOptions

    landing = load_scenario("landing").scenario
    bias_m = BIAS_SIGMA_M * float(np.random.default_rng([SEED, seed]).standard_normal())
    (finder,) = landing.range
    frames = replace(landing.frames, rate_hz=rate_hz)
    flight = simulate(replace(landing, frames=frames, range=(replace(finder, bias_m=bias_m),)), [SEED, 1, seed])
    rows = {}
    for name, (used, sigma_m) in TOLD.items():
        options = TrackerOptions(motion="range", range_bias_sigma_m=sigma_m)
        tracker = Tracker(flight.target_told, flight.camera, options)
        readings = SensorReadings(ranges=flight.ranges if used else (), attitudes=())
        found = []
        for view in flight.views:
            readings.tell(tracker, view)
            found.append(tracker.update(view))
        scores = score(answer_of(found, tracker.model), flight.T_true, flight.X_true)
        squares, hover = scores.translation_m**2, round(HOVER_S * rate_hz)
        estimated, sigma = tracker.range_bias
        error = estimated - bias_m
        rows[name] = [squares.mean(), squares[-hover:].mean(), scores.pose_nees.mean() / 6.0, error, sigma]
    return {name: [float(value) for value in values] for name, values in rows.items()}


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=24, help="flights, each with a bias of its own")
    parser.add_argument("--rate-hz", type=float, default=25.0, help="images a second")
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("-o", "--output", type=Path, required=True)
    return parser.parse_args(arguments)


def main(arguments: Sequence[str] | None = None) -> int:
    """Fly, then write range_bias.md."""
    os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
    import numpy as np

    options = parse(arguments)
    with multiprocessing.get_context("spawn").Pool(options.processes) as pool:
        flights = pool.map(partial(fly, rate_hz=options.rate_hz), range(options.runs), chunksize=1)
    lines = []
    for name, (_, told) in TOLD.items():
        rows = np.array([flight[name] for flight in flights])
        cells = [name, *(f"{root:.2f}" for root in np.sqrt(rows[:, :2].mean(0))), f"{rows[:, 2].mean():.2f}"]
        if told:
            bias, sigma = rows[:, 3], rows[:, 4]
            cells += [f"{np.sqrt(np.mean(each**2)):.2f}" for each in (bias, sigma)]
            cells.append(f"{np.mean((bias / sigma) ** 2):.2f}")
        lines.append([*cells, *[""] * (len(HEADINGS) - len(cells))])
    write_table(options.output / "range_bias.md", HEADINGS, lines)
    return 0


if __name__ == "__main__":
    sys.exit(main())
