# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The covariance of a model whose frame is its own: what nobody can know of the frame is taken out.

docs/your-own-target.md eq. (5)-(7). Source: Baarda 1973, S-transformations and criterion matrices.
"""

import numpy as np

from fairlead.geometry import hat
from fairlead.types import ModelCovariance, Points3


def in_own_frame(covariance: ModelCovariance, X: Points3) -> ModelCovariance:
    """Q P Q^T with Q = I - G (G^T G)^-1 G^T, G the six rigid motions of the landmarks at X, eq. (5)."""
    about = X - X.mean(axis=0)
    G = np.concatenate([np.hstack([np.eye(3), -hat(x)]) for x in about])
    Q = np.eye(3 * len(X)) - G @ np.linalg.pinv(G)
    return _symmetric(Q @ covariance @ Q.T)


def with_fixed_distance(covariance: ModelCovariance, X: Points3, a: int, b: int) -> ModelCovariance:
    """Q P Q^T with Q = I - x0 d^T / (d^T x0), d the gradient of |X_b - X_a|: the scale is that distance's, eq. (6)."""
    x0 = (X - X.mean(axis=0)).ravel()
    d = np.zeros(3 * len(X))
    along = (X[b] - X[a]) / np.linalg.norm(X[b] - X[a])
    d[3 * a : 3 * a + 3], d[3 * b : 3 * b + 3] = -along, along
    Q = np.eye(3 * len(X)) - np.outer(x0, d) / (d @ x0)
    return _symmetric(Q @ covariance @ Q.T)


def with_scale_error(covariance: ModelCovariance, X: Points3, scale_sigma: float) -> ModelCovariance:
    """P + scale_sigma^2 x0 x0^T, x0 about the centroid, eq. (7)."""
    x0 = (X - X.mean(axis=0)).ravel()
    return _symmetric(covariance + scale_sigma**2 * np.outer(x0, x0))


def _symmetric(P: ModelCovariance) -> ModelCovariance:
    """Symmetric to the last bit, and a thousandth of its largest sigma free in every direction, for the solvers."""
    floor = 1e-6 * float(np.diag(P).max(initial=0.0))
    return 0.5 * (P + P.T) + floor * np.eye(len(P))
