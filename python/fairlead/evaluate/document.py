# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""An evaluation as JSON: every scalar and every landmark; the series of frames stay in errors.csv."""

import dataclasses
import math
from typing import cast

import numpy as np

from fairlead.evaluate.evaluation import AgainstTruth, Evaluation
from fairlead.evaluate.landmarks import LandmarkErrors
from fairlead.geometry import Similarity

VERSION = 1

Json = object
"""None, bool, int, float, str, or lists and dicts of them."""


def evaluation_to_json(evaluation: Evaluation) -> dict[str, Json]:
    """Content of metrics.json. NaN and what could not be computed are null; infinity is the text "inf"."""
    truth = evaluation.truth
    return {
        "version": VERSION,
        "coverage": {**_fields(evaluation.coverage), "rate": plain(evaluation.coverage.rate)},
        "pose": None if truth is None else _truth(truth),
        "model_before": plain(evaluation.model_before),
        "model_after": plain(evaluation.model_after),
        "model_change": plain(evaluation.model_change),
        "reprojection": plain(evaluation.reprojection),
        "update_time": plain(evaluation.update_time),
    }


def _truth(truth: AgainstTruth) -> dict[str, Json]:
    matching, failures = truth.matching, truth.raw.failures
    return {
        "frames": {
            "judged": matching.n_matched,
            "truth": matching.n_truth,
            "truth_without_estimate": matching.n_truth_left_over,
            "by_nearest_stamp": matching.n_by_nearest,
            "largest_offset_ns": matching.largest_offset_ns,
        },
        "failures": {**_fields(failures), "rate": plain(failures.rate)},
        "raw": plain(truth.raw),
        "se3": plain(truth.se3),
        "sim3": plain(truth.sim3),
        "nees": plain(truth.consistency.nees),
        "trajectory": plain(truth.trajectory),
        "surface": plain(truth.surface),
    }


def plain(value: object) -> Json:
    """A value of an evaluation as JSON. Raises TypeError for what metrics.json has no form for."""
    if isinstance(value, LandmarkErrors):
        errors = cast(list[float], value.errors_m.tolist())
        per_landmark = {name: plain(error) for name, error in zip(value.names, errors, strict=True)}
        return {**_fields(value), "per_landmark_m": per_landmark}
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return _fields(value)
    if isinstance(value, float):
        if math.isnan(value):
            return None
        return value if math.isfinite(value) else str(value)
    if isinstance(value, tuple):
        return [plain(item) for item in cast(tuple[object, ...], value)]
    if value is None or isinstance(value, bool | int | str):
        return value
    raise TypeError(f"metrics.json has no form for {type(value).__name__}")


def _fields(value: object) -> dict[str, Json]:
    """All fields but arrays and the alignment itself, which the scale, rotation and shift beside it describe."""
    assert dataclasses.is_dataclass(value)
    named = {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
    return {name: plain(item) for name, item in named.items() if not isinstance(item, np.ndarray | Similarity)}
