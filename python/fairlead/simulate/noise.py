# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""How detections scatter: white, heavy-tailed, alike in time or in view. docs/simulate.md eq. (19)-(23), (31)."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float64

from fairlead.simulate.field import stationary_field, waves
from fairlead.simulate.limits import expect, expect_at_least_zero, expect_positive
from fairlead.simulate.rotations import Times
from fairlead.simulate.streams import Streams
from fairlead.types import Points3

Offsets = Float64[np.ndarray, "k n 2"]
Sigmas = Float64[np.ndarray, "k n"]
Away = Float64[np.ndarray, "k 3"]


@dataclass(frozen=True, kw_only=True)
class Noise:
    """Error of a detection in the image, and what the detector says of it."""

    sigma_px: float = 1.0
    """1 sigma of each image coordinate, at the reference range and seen from straight ahead [px]."""
    told_factor: float = 1.0
    """The detector tells standard deviations multiplied by this [-]."""
    told: Literal["actual", "constant"] = "actual"
    """What is multiplied: the sigma of each observation, or sigma_px for all."""
    tail_dof: float = 0.0
    """Degrees of freedom of Student's t, above 2, at the same variance; 0: Gaussian [-]."""
    correlation_time_s: float = 0.0
    """After this time the error of a landmark is alike by exp(-1); 0: white [s]."""
    correlation_angle_deg: float = 0.0
    """After this turn of the line of sight in the target frame, the same; 0: it makes no difference [deg]."""
    correlation_log_range: float = 0.0
    """After this change of the logarithm of the range, the same; 0: it makes no difference [-]."""
    reference_range_m: float = 1000.0
    """Where the range makes no difference [m]."""
    range_exponent: float = 0.0
    """Sigma grows with this power of the range; 1: in proportion [-]."""
    aspect_gain: float = 0.0
    """Sigma is 1 + this times larger seen from behind, half of it from the side [-]."""
    bias_px: float = 0.0
    """1 sigma of an error per landmark that stays through the flight, image coordinates [px]."""
    bias_m: float = 0.0
    """1 sigma of how far from each landmark the point lies that is found instead, target axes [m]."""

    def __post_init__(self) -> None:
        for field in ("sigma_px", "told_factor", "reference_range_m"):
            expect_positive(field, getattr(self, field))
        for field in ("correlation_time_s", "correlation_angle_deg", "correlation_log_range"):
            expect_at_least_zero(field, getattr(self, field))
        for field in ("aspect_gain", "bias_px", "bias_m"):
            expect_at_least_zero(field, getattr(self, field))
        heavy = self.tail_dof == 0.0 or self.tail_dof > 2.0
        expect("range_exponent", self.range_exponent, "-4 to 4", when=-4.0 <= self.range_exponent <= 4.0)
        expect("tail_dof", self.tail_dof, "0 or a number > 2", when=heavy)

    @property
    def uniform(self) -> bool:
        """Whether all observations have the same sigma."""
        return self.range_exponent == 0.0 and self.aspect_gain == 0.0

    def sigmas(self, ranges_m: Sigmas, cosines: Sigmas) -> Sigmas:
        """sigma_kj [px], eq. (21); `cosines` of the angle between normal and direction to the camera."""
        slant = 1.0 + self.aspect_gain * 0.5 * (1.0 - cosines)
        return self.sigma_px * (ranges_m / self.reference_range_m) ** self.range_exponent * slant

    def told_sigmas(self, sigmas: Sigmas) -> Sigmas:
        """What the detector says [px]."""
        return self.told_factor * (sigmas if self.told == "actual" else np.full(sigmas.shape, self.sigma_px))

    @property
    def stays(self) -> bool:
        """Whether errors depend on the view."""
        return self.correlation_angle_deg > 0.0 or self.correlation_log_range > 0.0

    def draw(self, turns: Times, away: Away, sigmas: Sigmas, streams: Streams) -> Offsets:
        """Errors of all observations [px], eq. (19), (20), (22) and (31); the bias is included.

        `away`: from the landmarks' centroid to the camera, target axes [m].
        """
        shape = (*sigmas.shape, 2)
        rng = streams.of("noise")
        errors = self._staying(turns, away, shape[1:], rng) if self.stays else rng.standard_normal(shape)
        if self.correlation_time_s > 0.0 and not self.stays:
            remember(errors, np.exp(-np.diff(turns) / self.correlation_time_s))
        if self.tail_dof > 0.0:
            chi_squares = streams.of("tail").chisquare(self.tail_dof, sigmas.shape)
            errors *= np.sqrt((self.tail_dof - 2.0) / chi_squares)[..., None]
        errors *= sigmas[..., None]
        if self.bias_px > 0.0:
            errors += self.bias_px * streams.of("bias_px").standard_normal(shape[1:])
        return errors

    def _staying(self, turns: Times, away: Away, shape: tuple[int, ...], rng: np.random.Generator) -> Offsets:
        """Eq. (31)."""
        ranges_m = np.linalg.norm(away, axis=1, keepdims=True)
        places = np.hstack([away / ranges_m, np.log(ranges_m), turns[:, None]])
        lengths = (
            (3, np.radians(self.correlation_angle_deg)),
            (1, self.correlation_log_range),
            (1, self.correlation_time_s),
        )
        vectors = np.hstack([waves(dimensions, float(length), rng) for dimensions, length in lengths])
        return stationary_field(places, vectors, shape, rng)

    def found_instead(self, X: Points3, streams: Streams) -> Points3:
        """The points that the detector finds, eq. (23) [m]."""
        return X + self.bias_m * streams.of("bias_m").standard_normal(X.shape) if self.bias_m > 0.0 else X


def remember(errors: Offsets, alike: Float64[np.ndarray, "intervals"]) -> None:
    """In place: e_k = a_k e_k-1 + sqrt(1 - a_k^2) w_k, so that the variance stays 1; eq. (20)."""
    fresh = np.sqrt(1.0 - alike**2)
    for k in range(1, len(errors)):
        errors[k] *= fresh[k - 1]
        errors[k] += alike[k - 1] * errors[k - 1]
