# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Monocular 6D pose of a rigid target whose 3D model is only roughly known.

Names are imported when they are first used, so that `import fairlead` is fast.
"""

import importlib
from typing import TYPE_CHECKING

__version__: str

if TYPE_CHECKING:
    from fairlead.io.attitudes import read_attitudes, write_attitudes
    from fairlead.io.camera import load_camera, save_camera
    from fairlead.io.errors import InputError
    from fairlead.io.observations import read_views, write_views
    from fairlead.io.poses import read_poses, read_truth, write_poses, write_truth
    from fairlead.io.ranges import read_ranges, write_ranges
    from fairlead.io.target import load_target, save_target
    from fairlead.io.tum import write_trajectory_tum
    from fairlead.tracker import Refinement, Tracker, TrackerOptions, refine
    from fairlead.types import (
        AttitudeReading,
        Camera,
        Estimate,
        KnownDistance,
        MotionPrior,
        PoseEstimator,
        RangeReading,
        Target,
        TruthPose,
        View,
    )

__all__ = [
    "AttitudeReading",
    "Camera",
    "Estimate",
    "InputError",
    "KnownDistance",
    "MotionPrior",
    "PoseEstimator",
    "RangeReading",
    "Refinement",
    "Target",
    "Tracker",
    "TrackerOptions",
    "TruthPose",
    "View",
    "__version__",
    "load_camera",
    "load_target",
    "read_attitudes",
    "read_poses",
    "read_ranges",
    "read_truth",
    "read_views",
    "refine",
    "save_camera",
    "save_target",
    "write_attitudes",
    "write_poses",
    "write_ranges",
    "write_trajectory_tum",
    "write_truth",
    "write_views",
]

_HOME = {
    "fairlead.io.attitudes": ("read_attitudes", "write_attitudes"),
    "fairlead.io.camera": ("load_camera", "save_camera"),
    "fairlead.io.errors": ("InputError",),
    "fairlead.io.observations": ("read_views", "write_views"),
    "fairlead.io.poses": ("read_poses", "read_truth", "write_poses", "write_truth"),
    "fairlead.io.ranges": ("read_ranges", "write_ranges"),
    "fairlead.io.target": ("load_target", "save_target"),
    "fairlead.io.tum": ("write_trajectory_tum",),
    "fairlead.tracker": ("Refinement", "Tracker", "TrackerOptions", "refine"),
    "fairlead.types": (
        *("AttitudeReading", "Camera", "Estimate", "KnownDistance", "MotionPrior", "PoseEstimator", "RangeReading"),
        *("Target", "TruthPose", "View"),
    ),
}
_MODULE_OF = {name: module for module, names in _HOME.items() for name in names}


if not TYPE_CHECKING:  # a type checker shall still know what is not there

    def __getattr__(name: str) -> object:
        if name == "__version__":
            return importlib.import_module("importlib.metadata").version("fairlead")
        if name not in _MODULE_OF:
            raise AttributeError(f"module 'fairlead' has no attribute {name!r}")
        value = getattr(importlib.import_module(_MODULE_OF[name]), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted(__all__)
