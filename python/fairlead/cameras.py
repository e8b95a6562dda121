# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Central cameras in numpy, independent of the C++ core: docs/cameras.md eq. (1)-(7), (9).

Sources: OpenCV calib3d manual (plumb_bob, rational); Kannala and Brandt 2006, eq. (6) (equidistant).
"""

import numpy as np

from fairlead.types import Camera, Pixels, Points3, Rays

MIN_DEPTH_M = 1e-6
"""Points nearer than this along the optical axis are not projected [m]."""

_ITERATIONS = 50
_CONVERGED = 1e-12


def project(camera: Camera, points_camera: Points3) -> Pixels:
    """Pixels z = pi(p_camera) [px], row by row.

    NaN rows for points that are not finite, whose depth is below MIN_DEPTH_M, or that lie where the distortion folds
    back onto the image.
    """
    pixels = np.full((len(points_camera), 2), np.nan)
    with np.errstate(all="ignore"):
        visible = np.isfinite(points_camera).all(axis=1) & (points_camera[:, 2] >= MIN_DEPTH_M)
        if camera.model == "equidistant":
            angles, directions = _polar(points_camera[visible])
            distorted = _theta(camera, angles)[:, None] * directions
            valid = angles <= distortion_limit(camera)
        else:
            plane = points_camera[visible, :2] / points_camera[visible, 2:]
            distorted = _distort(camera, plane)
            valid = np.linalg.norm(plane, axis=1) <= distortion_limit(camera)
    rows = np.flatnonzero(visible)[valid]
    pixels[rows] = distorted[valid] * np.diag(camera.K)[:2] + camera.K[:2, 2]
    return pixels


def unproject(camera: Camera, pixels: Pixels) -> Rays:
    """Unit rays through pixels: project(camera, unproject(camera, z)) = z. NaN rows where there is none."""
    distorted = (pixels - camera.K[:2, 2]) / np.diag(camera.K)[:2]
    with np.errstate(all="ignore"):
        if camera.model == "equidistant":
            rays = _unproject_equidistant(camera, distorted)
        else:
            plane = _undistort(camera, distorted)
            rays = np.column_stack([plane, np.ones(len(plane))])
            rays[~(np.linalg.norm(plane, axis=1) <= distortion_limit(camera))] = np.nan
        return rays / np.linalg.norm(rays, axis=1, keepdims=True)


def distortion_limit(camera: Camera) -> float:
    """Largest radius (tan theta; equidistant: theta [rad]) up to which the radial distortion grows; inf if always."""
    if not camera.distortion.any():
        return 0.5 * np.pi if camera.model == "equidistant" else np.inf
    if camera.model == "equidistant":
        odd = np.polynomial.Polynomial([0.0, 1.0, *np.ravel(np.column_stack([np.zeros(4), camera.distortion]))])
        return min(_first_root(odd.deriv()), 0.5 * np.pi)
    numerator, denominator = _radial_polynomials(camera)
    radius = np.polynomial.Polynomial([0.0, 1.0])
    slope = (radius * numerator).deriv() * denominator - radius * numerator * denominator.deriv()
    return min(_first_root(slope), _first_root(denominator))


def _first_root(polynomial: np.polynomial.Polynomial) -> float:
    roots = polynomial.trim().roots()
    real = roots[np.abs(roots.imag) < 1e-9 * np.maximum(1.0, np.abs(roots))].real
    return float(real[real > 0.0].min(initial=np.inf))


def _radial_polynomials(camera: Camera) -> tuple[np.polynomial.Polynomial, np.polynomial.Polynomial]:
    """1 + k1 r^2 + k2 r^4 + k3 r^6 and 1 + k4 r^2 + k5 r^4 + k6 r^6 as polynomials of r."""
    k = np.zeros(8)
    k[: camera.distortion.size] = camera.distortion
    numerator = np.polynomial.Polynomial([1.0, 0.0, k[0], 0.0, k[1], 0.0, k[4]])
    return numerator, np.polynomial.Polynomial([1.0, 0.0, k[5], 0.0, k[6], 0.0, k[7]])


def _distort(camera: Camera, plane: Pixels) -> Pixels:
    """At depth 1: x' = x f(r) + 2 p1 x y + p2 (r^2 + 2 x^2), y' = y f(r) + p1 (r^2 + 2 y^2) + 2 p2 x y."""
    if camera.model == "pinhole":
        return plane
    p1, p2 = camera.distortion[2:4]
    x, y = plane[:, 0], plane[:, 1]
    square = x * x + y * y
    numerator, denominator = _radial_polynomials(camera)
    radial = numerator(np.sqrt(square)) / denominator(np.sqrt(square))
    tangential_x = 2.0 * p1 * x * y + p2 * (square + 2.0 * x * x)
    tangential_y = p1 * (square + 2.0 * y * y) + 2.0 * p2 * x * y
    return np.column_stack([x * radial + tangential_x, y * radial + tangential_y])


def _undistort(camera: Camera, distorted: Pixels) -> Pixels:
    """Newton's method on `_distort`, its Jacobian by central differences; NaN rows where it does not converge."""
    plane = distorted.copy()
    step = 1e-6
    residual = _distort(camera, plane) - distorted
    for _ in range(_ITERATIONS):
        J = np.empty((len(plane), 2, 2))
        for axis in range(2):
            offset = step * np.eye(2)[axis]
            J[:, :, axis] = (_distort(camera, plane + offset) - _distort(camera, plane - offset)) / (2.0 * step)
        determinant = J[:, 0, 0] * J[:, 1, 1] - J[:, 0, 1] * J[:, 1, 0]
        dx = (J[:, 1, 1] * residual[:, 0] - J[:, 0, 1] * residual[:, 1]) / determinant
        dy = (J[:, 0, 0] * residual[:, 1] - J[:, 1, 0] * residual[:, 0]) / determinant
        plane = plane - np.column_stack([dx, dy])
        residual = _distort(camera, plane) - distorted
        if not (np.abs(residual) > _CONVERGED).any():
            break
    plane[~(np.abs(residual).max(axis=1, initial=0.0) <= 1e-9)] = np.nan
    return plane


def _polar(points_camera: Points3) -> tuple[np.ndarray, Pixels]:
    """Angle from the optical axis [rad] (n,) and unit direction in the image (n, 2); (0, 0) on the axis."""
    radius = np.linalg.norm(points_camera[:, :2], axis=1)
    directions = np.where(
        radius[:, None] > 0.0, points_camera[:, :2] / np.where(radius > 0.0, radius, 1.0)[:, None], 0.0
    )
    return np.arctan2(radius, points_camera[:, 2]), directions


def _theta(camera: Camera, angles: np.ndarray) -> np.ndarray:
    """theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)."""
    return angles * np.polynomial.Polynomial([1.0, *camera.distortion])(angles**2)


def _unproject_equidistant(camera: Camera, distorted: Pixels) -> Rays:
    radius = np.linalg.norm(distorted, axis=1)
    slope = np.polynomial.Polynomial([1.0, *(camera.distortion * [3.0, 5.0, 7.0, 9.0])])
    limit = distortion_limit(camera)
    angles = np.minimum(radius, limit)
    for _ in range(_ITERATIONS):
        angles = np.clip(angles - (_theta(camera, angles) - radius) / slope(angles**2), 0.0, limit)
    angles = np.where(np.abs(_theta(camera, angles) - radius) <= 1e-9, angles, np.nan)
    directions = distorted / np.where(radius > 0.0, radius, 1.0)[:, None]
    return np.column_stack([np.sin(angles)[:, None] * directions, np.cos(angles)])
