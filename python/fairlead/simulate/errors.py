# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""How the world differs from what the estimator is told: errors of the model and of the observations."""

from dataclasses import dataclass

import numpy as np

from fairlead.simulate.limits import expect, expect_at_least_zero, expect_positive
from fairlead.types import ModelCovariance, PixelCovariances, Points3


@dataclass(frozen=True, kw_only=True)
class ModelError:
    """The estimator is told X0 ~ N(X, P0), P0 = C x diag(sigma_m^2) + scale_sigma^2 x x^T, x = X about its centroid.

    C_ij = exp(-|X_i - X_j| / correlation_length_m), the identity if that length is 0; docs/simulate.md eq. (28), (29).
    The truth X is given and what is told scatters about it, as when somebody has measured the target or drawn it from
    memory. (Where the truth scatters about a drawing, the same posterior has another bias: docs/bound.md.)
    """

    sigma_m: float | tuple[float, float, float] = 1.0
    """One standard deviation of each coordinate of each landmark, one for all axes or three [m]."""
    scale_sigma: float = 0.0
    """One standard deviation of the common scale error [-]."""
    correlation_length_m: float = 0.0
    """Landmarks this far apart err alike by exp(-1); 0: each by itself [m]."""
    told_factor: float = 1.0
    """The estimator is told standard deviations multiplied by this [-]."""
    told_independent: bool = False
    """The estimator is told neither of the correlation nor of the common scale, only sigma_m."""

    def __post_init__(self) -> None:
        sigmas = self.sigma_m if isinstance(self.sigma_m, tuple) else (self.sigma_m,)
        expect("sigma_m", self.sigma_m, "numbers >= 0", when=all(0.0 <= sigma < np.inf for sigma in sigmas))
        expect_at_least_zero("scale_sigma", self.scale_sigma)
        expect_at_least_zero("correlation_length_m", self.correlation_length_m)
        expect_positive("told_factor", self.told_factor)

    def draw(self, X_true: Points3, rng: np.random.Generator) -> Points3:
        """Landmarks that the estimator is told, X0 [m]."""
        errors = rng.standard_normal(X_true.shape)
        if self.correlation_length_m > 0.0:
            errors = factor(self._alike(X_true)) @ errors
        errors = np.asarray(self.sigma_m) * errors
        return X_true + errors + self.scale_sigma * rng.standard_normal() * (X_true - X_true.mean(axis=0))

    def told_covariance(self, X0: Points3) -> ModelCovariance:
        """told_factor^2 P0 at the told landmarks, (3n, 3n) [m^2]."""
        variances = np.broadcast_to(np.asarray(self.sigma_m), (3,)) ** 2
        covariance = np.diag(np.tile(variances, len(X0)))
        if self.correlation_length_m > 0.0 and not self.told_independent:
            covariance = np.kron(self._alike(X0), np.diag(variances))
        if self.scale_sigma > 0.0 and not self.told_independent:
            about = (X0 - X0.mean(axis=0)).ravel()
            covariance += self.scale_sigma**2 * np.outer(about, about)
        return self.told_factor**2 * covariance

    def _alike(self, X: Points3) -> np.ndarray:
        """C, (n, n) [-]; only where there is a length."""
        return np.exp(-np.linalg.norm(X[:, None] - X, axis=2) / self.correlation_length_m)


def factor(covariance: np.ndarray) -> np.ndarray:
    """F with F F^T = covariance, which may be singular."""
    try:
        return np.linalg.cholesky(covariance)
    except np.linalg.LinAlgError:
        values, vectors = np.linalg.eigh(covariance)
        return vectors * np.sqrt(np.maximum(values, 0.0))


@dataclass(frozen=True, kw_only=True)
class ObservationError:
    """White Gaussian pixel noise, and a share of observations that are wrong by a fixed distance."""

    sigma_px: float = 1.0
    """One standard deviation of each image coordinate [px]."""
    told_factor: float = 1.0
    """The estimator is told sigma_px multiplied by this [-]."""
    outlier_fraction: float = 0.0
    """Chance of each observation to be an outlier [-]."""
    outlier_px: float = 30.0
    """How far an outlier is off, in a direction uniform over the circle, on top of the noise [px]."""

    def __post_init__(self) -> None:
        if not (self.sigma_px > 0.0 and self.told_factor > 0.0 and 0.0 <= self.outlier_fraction <= 1.0):
            raise ValueError(f"observation error: expected sigma and factor > 0 and a fraction in 0..1, got {self}")

    def draw(self, pixels_true: np.ndarray, rng: np.random.Generator) -> np.ndarray:
        """Observed pixels, same shape (..., 2) [px]."""
        pixels = pixels_true + self.sigma_px * rng.standard_normal(pixels_true.shape)
        if self.outlier_fraction > 0.0:
            wrong = rng.random(pixels.shape[:-1]) < self.outlier_fraction
            direction = rng.uniform(0.0, 2.0 * np.pi, pixels.shape[:-1])
            offset = self.outlier_px * np.stack([np.cos(direction), np.sin(direction)], axis=-1)
            pixels += np.where(wrong[..., None], offset, 0.0)
        return pixels

    def told_covariances(self, n: int) -> PixelCovariances:
        """(n, 2, 2) [px^2]: what a view says of itself."""
        return np.tile((self.told_factor * self.sigma_px) ** 2 * np.eye(2), (n, 1, 1))
