# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of an evaluation. Importing this package imports matplotlib; nothing else in `evaluate` does."""

from fairlead.evaluate.figures.consistency import consistency
from fairlead.evaluate.figures.errors import errors_over_time, reprojection_over_time
from fairlead.evaluate.figures.model import landmark_shifts, landmarks_before_and_after, model_over_time
from fairlead.evaluate.figures.residuals import residuals
from fairlead.evaluate.figures.style import COLOURS
from fairlead.evaluate.figures.trajectory import trajectory

__all__ = [
    "COLOURS",
    "consistency",
    "errors_over_time",
    "landmark_shifts",
    "landmarks_before_and_after",
    "model_over_time",
    "reprojection_over_time",
    "residuals",
    "trajectory",
]
