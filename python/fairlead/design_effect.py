# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""How alike the errors of the landmarks of one view are, by what they do to its pose. docs/networks.md section 5."""

from collections.abc import Iterable

import numpy as np
from jaxtyping import Float64

from fairlead import geometry
from fairlead.types import Camera, Matrix4, PixelCovariances, Pixels, Points3

GATE = 18.42
"""Squares of whitened errors above this are gross errors, which an estimator leaves out; chi-square, 99.99 %."""
FEWEST = 6
"""Landmarks of a view that its pose is asked of."""
_STEP = 1e-5

Jacobian = Float64[np.ndarray, "n 2 6"]


def pose_jacobian(camera: Camera, T_camera_target: Matrix4, X_target: Points3) -> Jacobian:
    """Pixels by xi, T exp(xi) [px/m, px/rad], by central differences."""

    def pixels(xi: np.ndarray) -> Pixels:
        return geometry.project(camera, geometry.transform(geometry.perturb(T_camera_target, xi), X_target))

    return np.stack([(pixels(step) - pixels(-step)) / (2.0 * _STEP) for step in _STEP * np.eye(6)], axis=2)


def design_effect(views: Iterable[tuple[Pixels, PixelCovariances, Jacobian]]) -> float:
    """d = sum over views of q / 6 over that of s / 2n, at least 1; docs/networks.md eq. (8). A view: e, S, J.

    q = g^T H^-1 g with H = sum J^T S^-1 J and g = sum J^T S^-1 e: by how much a view's errors move its pose, squared
    and whitened; 6 if they are independent. s = sum e^T S^-1 e: 2n if the covariances are right. NaN if no view has
    FEWEST landmarks without gross errors.
    """
    moved, off = 0.0, 0.0
    for e, S, J in views:
        s = np.einsum("ni,nij,nj->n", e, np.linalg.inv(S), e)
        taken = s < GATE
        if np.count_nonzero(taken) < FEWEST:
            continue
        WJ = np.linalg.solve(S[taken], J[taken])
        H, g = np.einsum("nai,naj->ij", J[taken], WJ), np.einsum("nai,na->i", WJ, e[taken])
        unit = 1.0 / np.sqrt(np.diag(H))  # metres and radians differ by far in size
        moved += (unit * g) @ np.linalg.solve(unit[:, None] * H * unit, unit * g) / 6.0
        off += s[taken].mean() / 2.0
    return max(1.0, float(moved / off)) if off > 0.0 else float("nan")
