# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What of the target falls where in the image, docs/pipeline.md eq. (1)."""

import numpy as np

from fairlead import geometry, opencv
from fairlead.cameras import project
from fairlead.io.mesh import Mesh
from fairlead.opencv import Line
from fairlead.types import Camera, Estimate, Matrix4, PixelCovariances, Pixels, Points3

_STEP = 1e-4
"""Of the numerical derivative of the projection, as a share of the depth [-]."""
_RIM = 4.0
"""Drawn beyond the image [px]."""


def silhouette(camera: Camera, mesh: Mesh, T_camera_target: Matrix4, scale: float) -> list[Line]:
    """Edges of the target in the image, as closed lines [px], drawn at `scale` times the camera's resolution.

    Triangles that are not in front of the camera as a whole are left out.
    """
    corners = project(camera, geometry.transform(T_camera_target, mesh.vertices))[mesh.faces]
    corners = corners[np.isfinite(corners).all(axis=(1, 2))]
    size = np.array([camera.width, camera.height], dtype=np.float64)
    if not len(corners):
        return []
    low = np.clip(corners.min(axis=(0, 1)) - _RIM, -_RIM, size)
    high = np.clip(corners.max(axis=(0, 1)) + _RIM, -_RIM, size + _RIM)
    width, height = np.ceil((high - low) * scale).astype(int)
    if min(width, height) <= 0:
        return []
    mask = np.zeros((height, width), np.uint8)
    opencv.fill_triangles(mask, (corners - low) * scale)
    return [_smoothed(edge) / scale + low for edge in opencv.contours(mask)]


def _smoothed(edge: Line) -> Line:
    """Mean of five neighbours along a closed line: takes the stairs of the pixel grid out."""
    if len(edge) < 8:
        return edge
    return np.mean([np.roll(edge, shift, axis=0) for shift in range(-2, 3)], axis=0)


def landmark_ellipses(camera: Camera, estimate: Estimate, X: Points3) -> tuple[Pixels, PixelCovariances]:
    """Where points of the target fall, and the covariance of that place for that of the pose, eq. (1).

    S_z = D C D^T, with C = `geometry.point_covariance` and D = dpi/dp by central differences. NaN rows for points
    behind the camera.
    """
    T = estimate.T_camera_target
    points = geometry.transform(T, X)
    D = np.empty((len(X), 2, 3))
    for axis in range(3):
        step = _STEP * np.abs(points[:, 2:]) * np.eye(3)[axis]
        D[:, :, axis] = (project(camera, points + step) - project(camera, points - step)) / (2.0 * step[:, [axis]])
    C = np.array([geometry.point_covariance(T, estimate.covariance, point) for point in X]).reshape(-1, 3, 3)
    return project(camera, points), D @ C @ D.transpose(0, 2, 1)
