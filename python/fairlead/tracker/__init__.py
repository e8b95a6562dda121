# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The estimator for Python: typed wrappers of the C++ core, no algorithm.

`Tracker` takes one view after the other (mode `map`); `refine` solves a whole flight in one batch. docs/estimator.md.
"""

from fairlead.tracker.batch import Refinement, refine
from fairlead.tracker.core import LandmarkIndex, TrackerOptions, core_camera
from fairlead.tracker.online import Observability, Tracker

__all__ = ["LandmarkIndex", "Observability", "Refinement", "Tracker", "TrackerOptions", "core_camera", "refine"]
