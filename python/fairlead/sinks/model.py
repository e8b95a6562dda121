# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The refined landmark model as a sink: saved now and then, and at the end."""

import time
from pathlib import Path

from fairlead.io.target import save_target
from fairlead.types import Estimate, PoseEstimator

_INTERVAL_S = 1.0
_SHARE_OF_TIME = 0.02


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
