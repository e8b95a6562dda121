# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Aliases of the arrays in the records, and the words they may hold."""

from typing import Literal

import numpy as np
from jaxtyping import Float64

Points3 = Float64[np.ndarray, "n 3"]
"""Points, one a row [m]."""
Pixels = Float64[np.ndarray, "n 2"]
"""Image points, one a row [px]; (0, 0) is the centre of the top-left pixel."""
PixelCovariances = Float64[np.ndarray, "n 2 2"]
"""Covariance of each image point [px^2]."""
Rays = Float64[np.ndarray, "n 3"]
"""Unit directions in the camera frame."""
Vector3 = Float64[np.ndarray, "3"]
Vector4 = Float64[np.ndarray, "4"]
Vector6 = Float64[np.ndarray, "6"]
Matrix3 = Float64[np.ndarray, "3 3"]
Matrix4 = Float64[np.ndarray, "4 4"]
Matrix6 = Float64[np.ndarray, "6 6"]
Poses = Float64[np.ndarray, "k 4 4"]
"""Rigid motions, one a block."""
Scores = Float64[np.ndarray, "n"]
Distortion = Float64[np.ndarray, "d"]
ModelCovariance = Float64[np.ndarray, "m m"]
"""Joint covariance of all landmarks, landmark after landmark, x y z each [m^2]; m = 3 n."""

CameraModel = Literal["pinhole", "plumb_bob", "rational_polynomial", "equidistant"]
Status = Literal["acquiring", "tracking", "coasting", "lost"]
MotionKind = Literal["range", "target", "world", "none"]

DISTORTION_SIZE: dict[CameraModel, int] = {"pinhole": 0, "plumb_bob": 5, "rational_polynomial": 8, "equidistant": 4}
"""Number of distortion coefficients of each camera model, docs/cameras.md."""
