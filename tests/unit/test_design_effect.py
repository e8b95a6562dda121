# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The pose's Jacobian, against the formula of a pinhole."""

import numpy as np

from fairlead import geometry
from fairlead.design_effect import pose_jacobian
from fairlead.types import Camera


def test_the_jacobian_is_that_of_a_pinhole() -> None:
    """f / z [1 0 -x/z; 0 1 -y/z] R [I, -[X]_x]."""
    K = np.array([[900.0, 0.0, 320.0], [0.0, 900.0, 240.0], [0.0, 0.0, 1.0]])
    camera = Camera(name="c", width=640, height=480, model="pinhole", K=K, distortion=np.zeros(0))
    T = geometry.inverse(geometry.exp_se3(np.array([3.0, -2.0, -40.0, 0.1, -0.2, 0.3])))
    X = np.random.default_rng(1).uniform(-5.0, 5.0, (4, 3))
    for found, point, (x, y, z) in zip(pose_jacobian(camera, T, X), X, geometry.transform(T, X), strict=True):
        by_point = 900.0 / z * np.array([[1.0, 0.0, -x / z], [0.0, 1.0, -y / z]])
        right = by_point @ T[:3, :3] @ np.hstack([np.eye(3), -geometry.hat(point)])
        np.testing.assert_allclose(found, right, rtol=1e-5, atol=1e-4)
