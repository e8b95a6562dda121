# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The landmark model while it was refined: its error, and which model a frame belongs to."""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int64

from fairlead.evaluate.alignment import Alignment, model_alignment
from fairlead.evaluate.summary import Series, root_mean_square
from fairlead.io.model_history import ModelSample
from fairlead.types import Estimate, Points3, Target


@dataclass(frozen=True, kw_only=True, eq=False)
class ModelHistory:
    """Error of the landmark model over time. A sample holds until the next one."""

    seconds: Series
    """Since the first frame of the run [s]."""
    raw_m: Series
    """Rms over the landmarks [m], docs/metrics.md eq. (10)."""
    se3_m: Series
    """The same after the best rigid motion; NaN where it is not determined."""
    sim3_m: Series
    """The same after the best similarity."""
    sigma_m: Series
    """What the covariance promises: root of the mean trace per landmark [m]."""


def model_history(
    samples: Sequence[ModelSample], landmarks: Sequence[str], true: Target, *, stamps_ns: Int64[np.ndarray, " f"]
) -> ModelHistory | None:
    """Errors of all samples over the landmarks that are in the true model too. None where none is."""
    place = {name: row for row, name in enumerate(true.landmarks)}
    rows = [row for row, name in enumerate(landmarks) if name in place]
    if not rows or not stamps_ns.size:
        return None
    X_true = true.positions[[place[landmarks[row]] for row in rows]]
    _check(samples, len(landmarks))

    def rms(alignment: Alignment) -> Series:
        return np.array([_rms(sample.positions[rows], X_true, alignment) for sample in samples], dtype=np.float64)

    traces = [float(np.mean(np.sum(sample.sigmas_m[rows] ** 2, axis=1))) for sample in samples]
    return ModelHistory(
        seconds=np.array([1e-9 * (sample.stamp_ns - int(stamps_ns[0])) for sample in samples], dtype=np.float64),
        raw_m=rms("raw"),
        se3_m=rms("se3"),
        sim3_m=rms("sim3"),
        sigma_m=np.sqrt(np.array(traces, dtype=np.float64)),
    )


def _rms(X: Points3, X_true: Points3, alignment: Alignment) -> float:
    similarity = model_alignment(X, X_true, alignment)
    if similarity is None:
        return float("nan")
    return root_mean_square(np.linalg.norm(similarity.apply(X) - X_true, axis=1))


def models_of_frames(
    estimates: Sequence[Estimate], target0: Target, last: Target, samples: Sequence[ModelSample] | None
) -> list[Points3]:
    """The positions that each estimate belongs to [m]: the latest sample up to its stamp, before the first one X0.

    Without samples the last model serves all frames.
    """
    if not samples or target0.landmarks != last.landmarks:
        return [last.positions] * len(estimates)
    _check(samples, len(last.landmarks))
    stamps = [sample.stamp_ns for sample in samples]
    indices = [bisect_right(stamps, estimate.stamp_ns) - 1 for estimate in estimates]
    return [target0.positions if index < 0 else samples[index].positions for index in indices]


def _check(samples: Sequence[ModelSample], count: int) -> None:
    for sample in samples:
        if len(sample.positions) != count:
            raise ValueError(f"models: expected samples of {count} landmarks, got one of {len(sample.positions)}")
