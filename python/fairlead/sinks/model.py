# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The refined landmark model as a sink: saved now and then and at the end, and its history."""

import time
from pathlib import Path

from fairlead.io.csv_lines import CsvWriter
from fairlead.io.model_history import COLUMNS, history_rows
from fairlead.io.target import save_target
from fairlead.types import Estimate, PoseEstimator

_INTERVAL_S = 1.0
_SHARE_OF_TIME = 0.02
_GROWTH = 1.05


class ModelSink:
    """target_refined.toml and .npz of an estimator, replaced every second, or seldomer where saving takes long."""

    def __init__(self, path: Path, estimator: PoseEstimator) -> None:
        self._path = path
        self._estimator = estimator
        self._due_s = time.monotonic() + _INTERVAL_S
        self._changed = True

    def write(self, estimate: Estimate) -> None:
        """Save the model if that is due."""
        del estimate  # the model is the estimator's
        self._changed = True
        start_s = time.monotonic()
        if start_s >= self._due_s:
            self._save()
            end_s = time.monotonic()
            self._due_s = end_s + max(_INTERVAL_S, (end_s - start_s) / _SHARE_OF_TIME)

    def _save(self) -> None:
        save_target(self._path, self._estimator.model)
        self._changed = False

    def close(self) -> None:
        """Save the last model."""
        if self._changed:
            self._save()


class ModelHistorySink:
    """model_history.csv: after each of the first forty frames, then at frame numbers that grow by 5 %."""

    def __init__(self, path: Path, estimator: PoseEstimator) -> None:
        self._writer = CsvWriter(path, COLUMNS)
        self._estimator = estimator
        self._count = 0
        self._next = 1
        self._last: Estimate | None = None

    def write(self, estimate: Estimate) -> None:
        """Append the model if that is due."""
        self._count += 1
        self._last = estimate
        if self._count >= self._next:
            self._append(estimate)
            self._next = max(self._count + 1, int(self._count * _GROWTH))

    def _append(self, estimate: Estimate) -> None:
        self._writer.write_rows(history_rows(estimate.frame, estimate.stamp_ns, self._estimator.model))
        self._last = None

    def close(self) -> None:
        """Append the last model."""
        try:
            if self._last is not None:
                self._append(self._last)
        finally:
            self._writer.close()
