# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The accuracy grid: noise x angle x model error x what is told, every method on the same flights.

    python -m benchmarks.grid --runs 200 -o runs/grid
    python -m benchmarks.grid --runs 50 --data clean --only 's1-*' --methods map epnp -o runs/grid

May be stopped and started again: what is done is kept, one file per cell and method. To run a method anew after a
change, name it with --redo. Writes table.csv and table.md.
"""

import argparse
import fnmatch
import multiprocessing
import os
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=200, help="flights per cell")
    parser.add_argument("--data", nargs="+", default=["clean", "outliers-10", "outliers-30"])
    parser.add_argument(
        "--methods", nargs="+", help="default: all; on data with outliers the told variants of map are left out"
    )
    parser.add_argument("--only", default="*", help="cells whose name matches, such as 's1-a90-*'")
    parser.add_argument("--redo", nargs="*", default=[], help="methods whose kept scores are thrown away first")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("-o", "--output", type=Path, required=True)
    return parser.parse_args(arguments)


def _complete(job: tuple[object, str, list[str]], folder: Path, runs: int) -> str:
    from benchmarks.cells import Cell, complete_cell

    cell, data, names = job
    assert isinstance(cell, Cell)
    done = complete_cell(folder, cell, data, runs, names)
    return f"{data} {cell.name}: {' '.join(done) or 'kept'}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run what is missing, then write the tables."""
    os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")  # before any process loads numpy
    options = parse(arguments)
    from benchmarks.cells import all_cells, file_of
    from benchmarks.grid_table import write_tables
    from benchmarks.methods import METHODS, TOLD

    cells = [cell for cell in all_cells() if fnmatch.fnmatch(cell.name, options.only)]
    jobs: list[tuple[object, str, list[str]]] = []
    for data in options.data:
        every = ["bound", *METHODS, *(name for name in TOLD if data == "clean" and name != "map")]
        names = [name for name in every if options.methods is None or name in options.methods]
        jobs += [(cell, data, names) for cell in cells]
        for cell in cells:
            for name in set(options.redo) & set(names):
                file_of(options.output, cell, data, name).unlink(missing_ok=True)
    work = partial(_complete, folder=options.output, runs=options.runs)
    with multiprocessing.get_context("spawn").Pool(options.processes) as pool:
        for number, text in enumerate(pool.imap_unordered(work, jobs), start=1):
            print(f"{number}/{len(jobs)} {text}", file=sys.stderr)
    print(write_tables(options.output, cells, options.data, options.runs))
    return 0


if __name__ == "__main__":
    sys.exit(main())
