# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Corners between four squares of a chessboard: a blurred saddle fitted to grey values, docs/fiducials.md section 4."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64
from scipy.special import erf

from fairlead.opencv import GreyImage
from fairlead.types import PixelCovariances, Pixels

MAX_RADIUS_PX = 6
MIN_RADIUS_PX = 2.5
SQUARE_SHARE = 0.4
"""Radius of the fit as a share of the distance to the next corner: it meets no other."""
ITERATIONS = 25
MIN_CONTRAST = 4.0
"""Half the difference between black and white [grey levels]."""
MIN_SINE = 0.2
"""Of the angle between the two edges."""
MAX_STEP_SHARE = 0.2
"""Farther from its first guess, as a share of the distance to the next, a corner is not believed."""
_PARAMETERS = 11
_FLOOR_PX = 0.005


@dataclass(frozen=True, kw_only=True, eq=False)
class Saddles:
    """What was measured of n corners."""

    corners: Pixels
    """[px]"""
    covariances: PixelCovariances
    """[px^2]"""
    measured: Bool[np.ndarray, "n"]
    """False where the fit failed: those rows are NaN."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Patches:
    """Grey values about each corner."""

    x: Float64[np.ndarray, "n m"]
    y: Float64[np.ndarray, "n m"]
    values: Float64[np.ndarray, "n m"]
    weight: Float64[np.ndarray, "n m"]
    """1 within the radius, else 0."""
    side: int


def measure_saddles(image: GreyImage, guesses: Pixels) -> Saddles:
    """Fit g(x) = m + s^T x + a P + b P^2 + c P^3, docs/fiducials.md eq. (9), by least squares; covariance by eq. (10).

    P = E(d1 / sigma) E(d2 / sigma) with the distances d1, d2 to two lines through the corner, E(z) = erf(z / sqrt 2);
    b and c take up the camera's tone curve.

    Parameters
    ----------
    image : grey values
    guesses : (n, 2) corners to about a pixel
    """
    n = len(guesses)
    nothing = Saddles(
        corners=np.full((n, 2), np.nan), covariances=np.full((n, 2, 2), np.nan), measured=np.zeros(n, bool)
    )
    height, width = image.shape
    reach = MAX_RADIUS_PX + 1
    if n == 0 or min(height, width) <= 2 * reach:
        return nothing
    spacing = _spacing(guesses)
    radius = np.minimum(SQUARE_SHARE * spacing, MAX_RADIUS_PX)
    patches = _cut(image, guesses, radius, reach)
    p = _fit(patches, _start(patches, guesses))[0]
    near = np.hypot(*(p[:, :2] - guesses).T) < MAX_STEP_SHARE * spacing
    centres = np.where(near[:, None], p[:, :2], guesses)  # once more: OpenCV's guess may be half a disc off
    patches = _cut(image, centres, radius, reach)
    p, residuals, J = _fit(patches, np.where(near[:, None], p, _start(patches, guesses)))
    covariances = _covariances(residuals, J, patches)
    measured = (
        near
        & (np.hypot(*(p[:, :2] - centres).T) < 1.0)
        & np.isfinite(covariances).all(axis=(1, 2))
        & (np.abs(p[:, 6]) > MIN_CONTRAST)
        & (np.abs(np.sin(p[:, 2] - p[:, 3])) > MIN_SINE)
        & (np.exp(p[:, 4]) < 0.7 * radius)
        & (centres >= reach).all(axis=1)
        & (centres[:, 0] < width - reach)
        & (centres[:, 1] < height - reach)
        & (radius >= MIN_RADIUS_PX)
    )
    return Saddles(
        corners=np.where(measured[:, None], p[:, :2], np.nan),
        covariances=np.where(measured[:, None, None], covariances, np.nan),
        measured=measured,
    )


def _spacing(guesses: Pixels) -> np.ndarray:
    """Distance from each corner to the next one [px]; that of a lone corner is MAX_RADIUS_PX / SQUARE_SHARE."""
    apart = np.hypot(*(guesses[:, None] - guesses[None]).transpose(2, 0, 1))
    np.fill_diagonal(apart, np.inf)
    return np.minimum(apart.min(axis=1), 1e6) if len(guesses) > 1 else np.full(1, MAX_RADIUS_PX / SQUARE_SHARE)


def _cut(image: GreyImage, guesses: Pixels, radius: np.ndarray, reach: int) -> _Patches:
    height, width = image.shape
    offsets = np.arange(-reach, reach + 1)
    dy, dx = (grid.ravel() for grid in np.meshgrid(offsets, offsets, indexing="ij"))
    centre = np.clip(np.rint(guesses).astype(int), reach, [width - 1 - reach, height - 1 - reach])
    x, y = centre[:, :1] + dx, centre[:, 1:] + dy
    weight = np.hypot(x - guesses[:, :1], y - guesses[:, 1:]) <= radius[:, None]
    return _Patches(
        x=x.astype(np.float64),
        y=y.astype(np.float64),
        values=image[y, x].astype(np.float64),
        weight=weight.astype(np.float64),
        side=len(offsets),
    )


def _start(patches: _Patches, guesses: Pixels) -> np.ndarray:
    """First parameters cx cy theta1 theta2 log(sigma) m a sx sy b c, from the second harmonic about the corner."""
    dx, dy = patches.x - guesses[:, :1], patches.y - guesses[:, 1:]
    angle = np.arctan2(dy, dx)
    total = np.maximum(patches.weight.sum(axis=1), 1.0)
    mean = (patches.weight * patches.values).sum(axis=1) / total
    high = patches.weight * (patches.values - mean[:, None])
    cosine, sine = (high * np.cos(2.0 * angle)).sum(axis=1) / total, (high * np.sin(2.0 * angle)).sum(axis=1) / total
    phase = np.arctan2(sine, cosine)
    amplitude = 0.5 * np.pi * np.hypot(cosine, sine)
    zero = np.zeros_like(mean)
    quarter = 0.25 * np.pi
    return np.column_stack(
        [guesses, 0.5 * phase + quarter, 0.5 * phase - quarter, zero, mean, amplitude, zero, zero, zero, zero]
    )


def _model(patches: _Patches, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Weighted residuals (n, m) and Jacobian (n, m, 11)."""
    cx, cy, theta1, theta2, log_sigma, m, a, sx, sy, b, c = (column[:, None] for column in p.T)
    dx, dy = patches.x - cx, patches.y - cy
    sigma = np.exp(log_sigma)
    E: list[np.ndarray] = []
    slope: list[np.ndarray] = []
    distance: list[np.ndarray] = []
    for theta in (theta1, theta2):
        d = (np.cos(theta) * dx + np.sin(theta) * dy) / sigma
        E.append(erf(d / np.sqrt(2.0)))
        slope.append(np.sqrt(2.0 / np.pi) * np.exp(-0.5 * d * d))
        distance.append(d)
    P = E[0] * E[1]
    dP = a + 2.0 * b * P + 3.0 * c * P * P
    along = [dP * slope[0] * E[1], dP * slope[1] * E[0]]
    columns = [
        -(along[0] * np.cos(theta1) + along[1] * np.cos(theta2)) / sigma - sx,
        -(along[0] * np.sin(theta1) + along[1] * np.sin(theta2)) / sigma - sy,
        along[0] * (np.cos(theta1) * dy - np.sin(theta1) * dx) / sigma,
        along[1] * (np.cos(theta2) * dy - np.sin(theta2) * dx) / sigma,
        -(along[0] * distance[0] + along[1] * distance[1]),
        np.ones_like(dx),
        P,
        dx,
        dy,
        P * P,
        P**3,
    ]
    residuals = m + sx * dx + sy * dy + P * (a + P * (b + P * c)) - patches.values
    return patches.weight * residuals, patches.weight[:, :, None] * np.stack(columns, axis=2)


def _fit(patches: _Patches, p: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Levenberg-Marquardt on all corners at once, each with its own damping."""
    damping = np.full(len(p), 1e-2)
    residuals, jacobian = _model(patches, p)
    for _ in range(ITERATIONS):
        H = jacobian.swapaxes(1, 2) @ jacobian
        diagonal = np.einsum("nii->ni", H)
        damped = H + (damping[:, None] * diagonal + 1e-9)[:, :, None] * np.eye(_PARAMETERS)
        g = (jacobian * residuals[:, :, None]).sum(axis=1)
        step = np.linalg.solve(damped, g[:, :, None])[:, :, 0]
        step[:, 4] = np.clip(step[:, 4], -0.5, 0.5)
        trial = p - step
        trial[:, 4] = np.clip(trial[:, 4], np.log(0.2), np.log(10.0))
        trial_residuals, trial_jacobian = _model(patches, trial)
        better = (trial_residuals**2).sum(axis=1) <= (residuals**2).sum(axis=1)
        p = np.where(better[:, None], trial, p)
        residuals = np.where(better[:, None], trial_residuals, residuals)
        jacobian = np.where(better[:, None, None], trial_jacobian, jacobian)
        damping = np.where(better, 0.2 * damping, 10.0 * damping).clip(1e-9, 1e9)
    return p, residuals, jacobian


def _covariances(residuals: np.ndarray, J: np.ndarray, patches: _Patches) -> PixelCovariances:
    """s^2 (J^T J)^-1 of the corner, s^2 from the residuals and widened by their correlation between neighbours."""
    count = patches.weight.sum(axis=1)
    s2 = (residuals**2).sum(axis=1) / np.maximum(count - _PARAMETERS, 1.0)
    grid = residuals.reshape(-1, patches.side, patches.side)
    inside = patches.weight.reshape(grid.shape)
    pairs = (inside[:, :, 1:] * inside[:, :, :-1]).sum(axis=(1, 2)) + (inside[:, 1:] * inside[:, :-1]).sum(axis=(1, 2))
    products = (grid[:, :, 1:] * grid[:, :, :-1]).sum(axis=(1, 2)) + (grid[:, 1:] * grid[:, :-1]).sum(axis=(1, 2))
    rho = np.clip(products / np.maximum(pairs * s2, 1e-12), 0.0, 0.8)
    H = J.swapaxes(1, 2) @ J
    scaled = 1.0 / np.sqrt(np.maximum(np.einsum("nii->ni", H), 1e-12))
    inverse = np.linalg.inv(scaled[:, :, None] * H * scaled[:, None, :] + 1e-10 * np.eye(_PARAMETERS))
    C = (scaled[:, :, None] * inverse * scaled[:, None, :])[:, :2, :2]
    widened = s2 * ((1.0 + rho) / (1.0 - rho)) ** 2
    enough = count > 2 * _PARAMETERS
    return np.where(enough[:, None, None], widened[:, None, None] * C + _FLOOR_PX**2 * np.eye(2), np.nan)
