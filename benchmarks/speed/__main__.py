# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Time the window solve and `update()` next to Ceres, GTSAM and SciPy.

    python -m benchmarks.speed -o runs/speed
    python -m benchmarks.speed -o runs/speed --only window update

Builds its C++ programs under build/speed (the core twice, portable and for this machine's instruction set). A peer that
is not installed is left out, with a line that says so. Writes speed.json, speed.md and speed_scaling.png; exit status 1
if a demand is missed.
"""

import argparse
import json
import os
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

PARTS = ("window", "update", "scaling")


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", choices=PARTS, default=list(PARTS))
    parser.add_argument(
        "--frames", type=int, default=1564, help="of the flight whose updates are timed (25 per second)"
    )
    parser.add_argument("--no-native", action="store_true", help="do not build for this machine's instruction set")
    parser.add_argument("--jobs", type=int, default=1, help="compilers at a time")
    parser.add_argument("-o", "--output", type=Path, required=True)
    return parser.parse_args(arguments)


def say(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


def gather(cores: dict[str, Path], jobs: int) -> dict[str, Any]:
    """Every solver that can be had here, by name; the portable build of the core first."""
    from benchmarks.speed.programs import Program, build_ceres
    from benchmarks.speed.scipy_peer import Scipy
    from benchmarks.speed.window import OURS

    solvers: dict[str, Any] = {
        OURS if name == "portable" else f"{OURS}, {name}": Program(path / "window") for name, path in cores.items()
    }
    ceres = build_ceres(jobs)
    if ceres is None:
        say("Ceres is not installed (Debian: libceres-dev): left out")
    else:
        solvers["Ceres"] = Program(ceres / "ceres_window")
    try:
        from benchmarks.speed.gtsam_peer import Gtsam

        solvers["GTSAM"] = Gtsam()
    except ImportError:
        say("GTSAM is not installed (PyPI: gtsam): left out")
    solvers["SciPy"] = Scipy()
    return solvers


def main(arguments: Sequence[str] | None = None) -> int:
    """Build, measure what is asked for, write; what an earlier run measured of the other parts is kept."""
    os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")  # before anything loads numpy
    options = parse(arguments)
    from benchmarks.speed.programs import build_core
    from benchmarks.speed.report import machine, markdown, metrics, verdicts
    from benchmarks.speed.scaling import draw, measure_scaling
    from benchmarks.speed.update import measure_updates
    from benchmarks.speed.window import measure_windows

    options.output.mkdir(parents=True, exist_ok=True)
    path = options.output / "speed.json"
    result: dict[str, Any] = {"windows": [], "updates": [], "scaling": {}}
    if path.exists():
        result.update(json.loads(path.read_text(encoding="utf-8")))
        result["scaling"] = {name: {int(k): t for k, t in curve.items()} for name, curve in result["scaling"].items()}
    say("building the programs")
    names = ("portable",) if options.no_native else ("portable", "native")
    cores = {name: build_core(native=name == "native", jobs=options.jobs) for name in names}
    solvers = gather(cores, options.jobs)
    if "window" in options.only:
        result["windows"] = measure_windows(solvers, say)
    if "update" in options.only:
        result["updates"] = measure_updates(cores, options.frames, say)
    if "scaling" in options.only:
        result["scaling"] = measure_scaling(solvers, say)
        draw(result["scaling"], options.output / "speed_scaling.png")
    result["machine"] = machine()
    result["metrics"] = [asdict(metric) for metric in metrics(result["windows"], result["updates"])]
    path.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    (options.output / "speed.md").write_text(markdown(result), encoding="utf-8")
    print(markdown(result))
    return 0 if all(met for met, _ in verdicts(result["windows"], result["updates"])) else 1


if __name__ == "__main__":
    sys.exit(main())
