# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Measure the accuracy that gates every change and compare it with the committed baseline.

    python -m benchmarks                     exit status 1 if something got worse
    python -m benchmarks --update-baseline   accept the new numbers, printing old -> new

Updating is a commit of its own that says why. The larger studies have their own commands: benchmarks.grid,
benchmarks.long_run.
"""

import argparse
import sys

from benchmarks.accuracy import measure
from benchmarks.metrics import BASELINE, compare, load_baseline, save_baseline


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--update-baseline", action="store_true")
    options = parser.parse_args()
    metrics = measure()
    baseline = load_baseline() if BASELINE.exists() else {}
    for metric in metrics:
        old = baseline.get(metric.key)
        was = f"{old.value:.6g} -> " if old is not None and old.value != metric.value else ""
        print(f"{metric.key}: {was}{metric.value:.6g} {metric.unit}")
    if options.update_baseline:
        save_baseline(metrics)
        return 0
    complaints = compare(metrics, baseline)
    for line in complaints:
        print(f"worse: {line}", file=sys.stderr)
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
