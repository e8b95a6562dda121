# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""model_history.csv: the landmark model while it was refined, docs/files.md."""

from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np

from fairlead.io.csv_lines import integer_cell, number_cell, read_csv
from fairlead.io.errors import InputError
from fairlead.types import Points3, Target

_POSITION = ("x_m", "y_m", "z_m")
_SIGMA = ("sigma_x_m", "sigma_y_m", "sigma_z_m")
COLUMNS = ("frame", "stamp_ns", "landmark", *_POSITION, *_SIGMA)


@dataclass(frozen=True, kw_only=True, eq=False)
class ModelSample:
    """The model after one frame."""

    frame: int
    stamp_ns: int
    positions: Points3
    """In the order of the target's landmarks [m]."""
    sigmas_m: Points3
    """Standard deviation of each coordinate [m]."""


def history_rows(frame: int, stamp_ns: int, model: Target) -> list[tuple[object, ...]]:
    """One sample, a row for each landmark, in the order of COLUMNS."""
    sigmas = np.sqrt(np.clip(np.diag(model.covariance), 0.0, None)).reshape(-1, 3)
    rows = zip(model.landmarks, model.positions.tolist(), sigmas.tolist(), strict=True)
    return [(frame, stamp_ns, name, *position, *sigma) for name, position, sigma in rows]


def read_model_history(path: Path | str, landmarks: tuple[str, ...]) -> list[ModelSample]:
    """Read model_history.csv of a target with these landmarks. Raises InputError (file, line)."""
    path = Path(path)
    samples: list[ModelSample] = []
    rows = (
        (integer_cell(cells, "frame", path, line), integer_cell(cells, "stamp_ns", path, line), line, cells)
        for line, cells in read_csv(path, COLUMNS)
    )
    for (frame, stamp_ns), group in groupby(rows, key=lambda row: row[:2]):
        members = [(line, cells) for _, _, line, cells in group]
        if tuple(cells["landmark"] for _, cells in members) != landmarks:
            raise InputError(path, f"frame {frame}: expected every landmark of the target in turn", line=members[0][0])
        numbers = np.array(
            [[number_cell(cells, name, path, line) for name in (*_POSITION, *_SIGMA)] for line, cells in members]
        )
        samples.append(ModelSample(frame=frame, stamp_ns=stamp_ns, positions=numbers[:, :3], sigmas_m=numbers[:, 3:]))
    return samples
