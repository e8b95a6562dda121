# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What a network's covariances are worth, and what makes them honest. docs/networks.md section 5."""

import numpy as np

from fairlead.design_effect import GATE
from fairlead.io.network_card import Calibration
from fairlead.train.findings import Findings

FLOORS_PX = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
DOFS = (2.2, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 8.0, 10.0, 15.0, 30.0, 100.0)
ENOUGH = 60
"""Rows of a landmark that a scale of its own is drawn from; with fewer it leans on that of all."""


def declared(findings: Findings, threshold: float) -> np.ndarray:
    """(m,) rows that a tracker would be told of and whose truth is in the crop."""
    return (findings.visible > threshold) & (findings.visibility > 0)


def covariances(findings: Findings, calibration: Calibration, landmarks: int) -> np.ndarray:
    """(m, 2, 2) S = scale S_network + floor^2 I, docs/networks.md eq. (6)."""
    scale = np.broadcast_to(np.array(calibration.scale), (landmarks,))[findings.landmark]
    return scale[:, None, None] * findings.covariance + calibration.floor_px**2 * np.eye(2)


def squared(findings: Findings, calibration: Calibration, landmarks: int) -> np.ndarray:
    """(m,) e^T S^-1 e."""
    S = covariances(findings, calibration, landmarks)
    return np.einsum("mi,mij,mj->m", findings.error, np.linalg.inv(S), findings.error)


def nees(squares: np.ndarray) -> np.ndarray:
    """(m,) min(s, 18.42) / 2: a gross error, beyond what 99.99 % of Gaussian ones keep, counts as one at that limit.

    Unbounded, a handful of pictures that were taken the wrong way round decides on the mean of thousands.
    """
    return 0.5 * np.minimum(squares, GATE)


def visible_threshold(findings: Findings) -> float:
    """The logit above which calling a landmark visible is right most often (F1 of visible landmarks)."""
    seen = findings.visibility == 2
    order = np.argsort(-findings.visible)
    hits = np.cumsum(seen[order])
    f1 = 2.0 * hits / (np.arange(1, len(order) + 1) + seen.sum())
    best = int(np.argmax(f1))
    return float(findings.visible[order][best])


def fit(findings: Findings, landmarks: int) -> Calibration:
    """Threshold, floor and shape of the tail by likelihood, each with the scales by which the mean `nees` is one.

    Bivariate Student t with covariance S and nu degrees of freedom, s = e^T S^-1 e, docs/networks.md eq. (7):
    log p = -1/2 log det S + log(nu / (nu - 2)) - (1 + nu / 2) log(1 + s / (nu - 2)) + const.
    """
    threshold = visible_threshold(findings)
    rows = findings.where(declared(findings, threshold))
    best: tuple[float, Calibration] | None = None
    for floor in FLOORS_PX:
        plain = Calibration(visible_threshold=threshold, floor_px=floor)
        scale = _scales(rows, plain, landmarks)
        for dof in DOFS:
            tried = Calibration(visible_threshold=threshold, floor_px=floor, scale=scale, tail_dof=dof)
            value = _log_likelihood(rows, tried, landmarks)
            if best is None or value > best[0]:
                best = value, tried
    assert best is not None
    return best[1]


def _scales(rows: Findings, calibration: Calibration, landmarks: int) -> tuple[float, ...]:
    """The scale of each landmark with which the mean `nees` is one, by bisection of its logarithm."""
    low, high = np.full(landmarks, -8.0), np.full(landmarks, 12.0)
    counts = np.bincount(rows.landmark, minlength=landmarks).astype(float)
    for _ in range(40):
        middle = 0.5 * (low + high)
        tried = Calibration(floor_px=calibration.floor_px, scale=tuple(np.exp(middle)))
        sums = np.bincount(rows.landmark, weights=nees(squared(rows, tried, landmarks)), minlength=landmarks)
        everyone = sums.sum() / max(counts.sum(), 1.0)
        mean = (sums + ENOUGH * everyone) / (counts + ENOUGH)
        low, high = np.where(mean > 1.0, middle, low), np.where(mean > 1.0, high, middle)
    return tuple(float(value) for value in np.exp(0.5 * (low + high)))


def _log_likelihood(rows: Findings, calibration: Calibration, landmarks: int) -> float:
    assert calibration.tail_dof is not None
    S = covariances(rows, calibration, landmarks)
    s = squared(rows, calibration, landmarks)
    nu = calibration.tail_dof
    density = np.log(nu / (nu - 2.0)) - (1.0 + 0.5 * nu) * np.log1p(s / (nu - 2.0))
    return float(np.mean(density - 0.5 * np.linalg.slogdet(S)[1]))
