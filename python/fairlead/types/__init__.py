# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Records that travel between the boxes, and the array aliases of their fields.

Every array is copied to float64 and set read-only; a record is never changed. Conventions: CONVENTIONS.md.
"""

from fairlead.types.arrays import (
    DISTORTION_SIZE,
    CameraModel,
    Distortion,
    Matrix3,
    Matrix4,
    Matrix6,
    ModelCovariance,
    MotionKind,
    PixelCovariances,
    Pixels,
    Points3,
    Poses,
    Rays,
    Scores,
    Status,
    Vector3,
    Vector4,
    Vector6,
)
from fairlead.types.checks import (
    RIGID_TOLERANCE,
    frozen_array,
    is_covariance,
    is_rigid,
)
from fairlead.types.correlation import (
    Correlation,
)
from fairlead.types.models import (
    Camera,
    KnownDistance,
    MotionPrior,
    Target,
)
from fairlead.types.readings import (
    AttitudeReading,
    RangeReading,
)
from fairlead.types.views import (
    Estimate,
    PoseEstimator,
    TruthPose,
    View,
    no_pose,
)

__all__ = [
    "DISTORTION_SIZE",
    "RIGID_TOLERANCE",
    "AttitudeReading",
    "Camera",
    "CameraModel",
    "Correlation",
    "Distortion",
    "Estimate",
    "KnownDistance",
    "Matrix3",
    "Matrix4",
    "Matrix6",
    "ModelCovariance",
    "MotionKind",
    "MotionPrior",
    "PixelCovariances",
    "Pixels",
    "Points3",
    "PoseEstimator",
    "Poses",
    "RangeReading",
    "Rays",
    "Scores",
    "Status",
    "Target",
    "TruthPose",
    "Vector3",
    "Vector4",
    "Vector6",
    "View",
    "frozen_array",
    "is_covariance",
    "is_rigid",
    "no_pose",
]
