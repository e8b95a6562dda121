# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines through edge points whose errors are correlated along the edge, docs/fiducials.md section 2."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

Sides = Float64[np.ndarray, "t 4"]
EdgePoints = Float64[np.ndarray, "t 4 m"]

MIN_STATIONS = 8
"""Fewer edge points do not show how they scatter."""
MIN_SHARE = 0.4
"""Share of the stations that must lie on the line."""
CORRELATION_PX = (0.3, 0.6, 1.2, 2.4, 4.8, 9.6, 19.2)
"""Correlation lengths tried along the edge [px]; the likeliest is taken."""
_BIWEIGHT = 4.0
"""Scaled residual beyond which a station is no part of the line."""
_ROBUST_STEPS = 8
_FLOOR_PX = 0.005
"""Standard deviation of a line's offset below which 8 bit images tell nothing [px]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Lines:
    """offset + slope * t with covariance, t [px] from the middle of the side; NaN for what is no line."""

    offset: Sides
    """[px]"""
    slope: Sides
    """[px/px]"""
    covariance: Float64[np.ndarray, "t 4 2 2"]
    """Of (offset, slope)."""

    def variance_at(self, t: Sides) -> Sides:
        """Variance of offset + slope * t [px^2]."""
        C = self.covariance
        return C[..., 0, 0] + 2.0 * t * C[..., 0, 1] + t * t * C[..., 1, 1]


def fit_lines(along: EdgePoints, offset: EdgePoints) -> Lines:
    """A robust line through the edge points of each side, docs/fiducials.md eq. (1)-(3).

    Parameters
    ----------
    along : positions along the side from its middle, rising [px]
    offset : where the edge is, along the outward normal [px]; NaN where it was not found
    """
    kept = _kept(along, offset)
    shape = along.shape[:2]
    lines = np.full((*shape, 2), np.nan)
    covariances = np.full((*shape, 2, 2), np.nan)
    for tag in range(shape[0]):
        enough = kept[tag].sum(axis=1) >= max(MIN_STATIONS, MIN_SHARE * along.shape[2])
        if not enough.all():
            continue
        sides = [(along[tag, i][kept[tag, i]], offset[tag, i][kept[tag, i]]) for i in range(4)]
        lines[tag], covariances[tag] = _correlated_fit(sides)
    return Lines(offset=lines[..., 0], slope=lines[..., 1], covariance=covariances)


def _kept(along: EdgePoints, offset: EdgePoints) -> np.ndarray:
    """Which stations lie on the line: iterated biweight (Beaton and Tukey 1974) with the residuals' median scale."""
    weight = np.isfinite(offset).astype(np.float64)
    e = np.nan_to_num(offset)
    found = weight > 0.0
    for step in range(_ROBUST_STEPS):
        total = np.maximum(weight.sum(axis=-1), 1e-9)
        mean_t = (weight * along).sum(axis=-1) / total
        mean_e = (weight * e).sum(axis=-1) / total
        t = along - mean_t[..., None]
        slope = (weight * t * e).sum(axis=-1) / np.maximum((weight * t * t).sum(axis=-1), 1e-9)
        if step == 0:  # start level with the median: one corner in the shade must not tilt the line
            masked = np.ma.masked_array(e, ~found)
            mean_e = np.ma.filled(np.ma.median(masked, axis=-1).astype(np.float64), 0.0)
            slope = np.zeros_like(slope)
        residual = e - mean_e[..., None] - slope[..., None] * t
        size = np.ma.filled(np.ma.median(np.ma.masked_array(np.abs(residual), ~found), axis=-1).astype(np.float64), 0.0)
        u = residual / (_BIWEIGHT * np.maximum(1.4826 * size, 0.02))[..., None]
        weight = np.where(found & (np.abs(u) < 1.0), (1.0 - u * u) ** 2, 0.0)
    return weight > 0.0


def _correlated_fit(sides: list[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Generalised least squares with exp(-distance / length) between errors; length and variance of all four sides
    together, by restricted likelihood (Patterson and Thompson 1971). Returns (4, 2) and (4, 2, 2).
    """
    whitened = [_whiten(t, e) for t, e in sides]
    normal = np.stack([A.swapaxes(-1, -2) @ A for A, _, _ in whitened])
    right = np.stack([(A * y[..., None]).sum(axis=-2) for A, y, _ in whitened])
    solution = np.linalg.solve(normal, right[..., None])[..., 0]
    squares = np.stack(
        [
            ((y - (A * x[:, None]).sum(axis=-1)) ** 2).sum(axis=-1)
            for (A, y, _), x in zip(whitened, solution, strict=True)
        ]
    ).sum(axis=0)
    freedom = sum(len(t) for t, _ in sides) - 8
    variance = np.maximum(squares / freedom, 1e-12)
    log_determinants = sum(log for _, _, log in whitened) + np.linalg.slogdet(normal)[1].sum(axis=0)
    best = int(np.argmin(freedom * np.log(variance) + log_determinants))
    covariances = variance[best] * np.linalg.inv(normal[:, best])
    covariances[:, 0, 0] += _FLOOR_PX**2
    return solution[:, best], covariances


def _whiten(t: np.ndarray, e: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Design (g, n, 2), data (g, n) and log det of the correlation (g,) for each length g, errors made white.

    Errors correlated as exp(-distance / length) are a Markov chain: each is whitened by its neighbour alone.
    """
    lengths = np.asarray(CORRELATION_PX)
    phi = np.exp(-np.diff(t) / lengths[:, None])
    scale = 1.0 / np.sqrt(1.0 - phi**2)
    y = np.column_stack([np.full(len(lengths), e[0]), (e[1:] - phi * e[:-1]) * scale])
    ones = np.column_stack([np.ones(len(lengths)), (1.0 - phi) * scale])
    slope = np.column_stack([np.full(len(lengths), t[0]), (t[1:] - phi * t[:-1]) * scale])
    return np.stack([ones, slope], axis=-1), y, np.log1p(-(phi**2)).sum(axis=-1)
