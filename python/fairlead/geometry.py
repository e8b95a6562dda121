# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Rigid motions and alignment in numpy, independent of the C++ core. Conventions: CONVENTIONS.md.

Cameras are in `fairlead.cameras`; `project` and `unproject` are offered here too.
"""

import math
from dataclasses import dataclass

import numpy as np

from fairlead.cameras import project, unproject
from fairlead.types import Matrix3, Matrix4, Matrix6, Points3, Vector3, Vector4, Vector6

__all__ = [
    "Similarity",
    "adjoint",
    "align_rigid",
    "align_similarity",
    "difference",
    "exp_se3",
    "exp_so3",
    "hat",
    "inverse",
    "log_se3",
    "log_so3",
    "matrix_from_quat_xyzw",
    "perturb",
    "point_covariance",
    "project",
    "quat_xyzw_from_matrix",
    "transform",
    "unproject",
]

_SMALL_ANGLE = 1e-4
"""Below this the series are used: their next term is under 1e-18 [rad]."""


def hat(v: Vector3) -> Matrix3:
    """The matrix of the cross product: hat(v) w = v x w."""
    x, y, z = v
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def exp_so3(phi: Vector3) -> Matrix3:
    """R = I + sin(a)/a hat(phi) + (1 - cos a)/a^2 hat(phi)^2, a = |phi| [rad] (Rodrigues)."""
    a, b, _ = _coefficients(float(np.linalg.norm(phi)))
    H = hat(phi)
    return np.eye(3) + a * H + b * (H @ H)


def _coefficients(angle: float) -> tuple[float, float, float]:
    """sin(a)/a, (1 - cos a)/a^2, (a - sin a)/a^3."""
    square = angle * angle
    if angle < _SMALL_ANGLE:
        return 1.0 - square / 6.0, 0.5 - square / 24.0, 1.0 / 6.0 - square / 120.0
    half = np.sin(0.5 * angle)
    return np.sin(angle) / angle, 2.0 * half * half / square, (angle - np.sin(angle)) / (square * angle)


def log_so3(R: Matrix3) -> Vector3:
    """Rotation vector phi with R = Exp(phi), |phi| <= pi [rad]; exact near pi too, by way of the quaternion."""
    quat = quat_xyzw_from_matrix(R)
    sine = float(np.linalg.norm(quat[:3]))
    if sine < 1e-12:
        return 2.0 * quat[:3]
    return 2.0 * float(np.arctan2(sine, quat[3])) / sine * quat[:3]


def exp_se3(xi: Vector6) -> Matrix4:
    """Exp(xi), xi = [rho; phi]: R = Exp(phi), t = V(phi) rho.

    V = I + (1 - cos a)/a^2 hat(phi) + (a - sin a)/a^3 hat(phi)^2. Source: Barfoot, State Estimation for Robotics,
    section 8.1.3 (his xi is ordered alike).
    """
    phi = xi[3:]
    _, b, c = _coefficients(float(np.linalg.norm(phi)))
    H = hat(phi)
    T = np.eye(4)
    T[:3, :3] = exp_so3(phi)
    T[:3, 3] = (np.eye(3) + b * H + c * (H @ H)) @ xi[:3]
    return T


def log_se3(T: Matrix4) -> Vector6:
    """Twist xi = [rho; phi] with T = Exp(xi); |phi| <= pi."""
    phi = log_so3(T[:3, :3])
    _, b, c = _coefficients(float(np.linalg.norm(phi)))
    H = hat(phi)
    V = np.eye(3) + b * H + c * (H @ H)
    return np.concatenate([np.linalg.solve(V, T[:3, 3]), phi])


def inverse(T: Matrix4) -> Matrix4:
    """T_b_a from T_a_b."""
    result = np.eye(4)
    result[:3, :3] = T[:3, :3].T
    result[:3, 3] = -T[:3, :3].T @ T[:3, 3]
    return result


def transform(T: Matrix4, points: Points3) -> Points3:
    """p_a = T_a_b p_b, row by row."""
    return points @ T[:3, :3].T + T[:3, 3]


def perturb(T: Matrix4, xi: Vector6) -> Matrix4:
    """T Exp(xi): the perturbation used everywhere."""
    return T @ exp_se3(xi)


def difference(T_a: Matrix4, T_b: Matrix4) -> Vector6:
    """Twist xi such that T_b = T_a Exp(xi)."""
    return log_se3(inverse(T_a) @ T_b)


def adjoint(T: Matrix4) -> Matrix6:
    """Ad(T) with T Exp(xi) = Exp(Ad(T) xi) T, xi = [rho; phi]."""
    R = T[:3, :3]
    result = np.zeros((6, 6))
    result[:3, :3] = R
    result[:3, 3:] = hat(T[:3, 3]) @ R
    result[3:, 3:] = R
    return result


def quat_xyzw_from_matrix(R: Matrix3) -> Vector4:
    """Unit quaternion x y z w with w >= 0 of a rotation matrix.

    The largest component is computed first. Source: Shepperd 1978, Quaternion from Rotation Matrix.
    """
    rows: list[list[float]] = R.tolist()
    trace = rows[0][0] + rows[1][1] + rows[2][2]
    squares = [1.0 + 2.0 * rows[axis][axis] - trace for axis in range(3)]
    i = max(range(3), key=squares.__getitem__)
    if squares[i] < 1.0 + trace:
        components = [rows[2][1] - rows[1][2], rows[0][2] - rows[2][0], rows[1][0] - rows[0][1], 1.0 + trace]
    else:
        j, k = (i + 1) % 3, (i + 2) % 3
        components = [0.0, 0.0, 0.0, rows[k][j] - rows[j][k]]
        components[i] = squares[i]
        components[j] = rows[j][i] + rows[i][j]
        components[k] = rows[k][i] + rows[i][k]
    norm = math.copysign(math.hypot(*components), components[3])
    return np.array([component / norm for component in components])


def matrix_from_quat_xyzw(quat_xyzw: Vector4) -> Matrix3:
    """Rotation matrix of a quaternion x y z w, normalised first. Raises ValueError if its norm is 0 or not finite."""
    norm = float(np.linalg.norm(quat_xyzw))
    if not np.isfinite(norm) or norm == 0.0:
        raise ValueError(f"quaternion: expected a finite norm above 0, got {norm}")
    x, y, z, w = quat_xyzw / norm
    return np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
            [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
            [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Similarity:
    """p_a = scale R_a_b p_b + t_a_b."""

    scale: float
    R_a_b: Matrix3
    t_a_b: Vector3

    def apply(self, points_b: Points3) -> Points3:
        """The points in a."""
        return self.scale * points_b @ self.R_a_b.T + self.t_a_b


def align_rigid(points_a: Points3, points_b: Points3) -> Similarity:
    """The motion (scale 1) that minimises sum |a - (R b + t)|^2; errors as in `align_similarity`."""
    return _align(points_a, points_b, with_scale=False)


def align_similarity(points_a: Points3, points_b: Points3) -> Similarity:
    """The similarity that minimises sum |a - (s R b + t)|^2, never a reflection.

    Source: Umeyama 1991, Least-squares estimation of transformation parameters between two point patterns,
    eq. (40)-(43).
    Raises ValueError for fewer than 3 points, numbers that are not finite, or points on a line.
    """
    return _align(points_a, points_b, with_scale=True)


def _align(points_a: Points3, points_b: Points3, *, with_scale: bool) -> Similarity:
    if points_a.shape != points_b.shape or points_a.ndim != 2 or points_a.shape[1] != 3 or len(points_a) < 3:
        raise ValueError(f"alignment: expected two times n >= 3 points, got {points_a.shape} and {points_b.shape}")
    if not (np.isfinite(points_a).all() and np.isfinite(points_b).all()):
        raise ValueError("alignment: expected finite points")
    mean_a, mean_b = points_a.mean(axis=0), points_b.mean(axis=0)
    centred_a, centred_b = points_a - mean_a, points_b - mean_b
    U, singular, Vt = np.linalg.svd(centred_a.T @ centred_b / len(points_a))
    if singular[1] <= 1e-9 * singular[0] or singular[0] == 0.0:
        raise ValueError("alignment: the points lie on a line; their rotation is not determined")
    signs = np.array([1.0, 1.0, np.sign(np.linalg.det(U) * np.linalg.det(Vt))])
    R = (U * signs) @ Vt
    variance_b = float((centred_b**2).sum(axis=1).mean())
    scale = float(singular @ signs) / variance_b if with_scale else 1.0
    return Similarity(scale=scale, R_a_b=R, t_a_b=mean_a - scale * R @ mean_b)


def point_covariance(T_a_b: Matrix4, covariance: Matrix6, X_b: Vector3) -> Matrix3:
    """Covariance of p_a = T_a_b X_b [m^2] for that of xi in T Exp(xi): C = R J S J^T R^T, J = [I, -hat(X)].

    CONVENTIONS.md eq. (7).
    """
    R = T_a_b[:3, :3]
    J = np.hstack([R, -R @ hat(X_b)])
    C = J @ covariance @ J.T
    return 0.5 * (C + C.T)
