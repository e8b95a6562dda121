# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Answers of one method on a block of runs to one row of numbers per run, docs/study.md section 4."""

import numpy as np
from scipy.spatial.transform import Rotation

from fairlead.evaluate.failures import FAILURE_ROTATION_DEG, FAILURE_TRANSLATION_PERCENT, failed_frames
from fairlead.evaluate.pose import range_m, rotation_error_deg, translation_error_m
from fairlead.study.flights import FlightBlock
from fairlead.study.methods import Answers, Method

Columns = dict[str, np.ndarray]

ERRORS = ("rotation_deg", "translation_m", "landmark_m")
"""Mean over views (or landmarks) of one run."""
COLUMNS = (
    *ERRORS,
    "rotation_rms_deg",
    "translation_rms_m",
    "landmark_rms_m",
    "rotation_penalised_deg",
    "translation_penalised_m",
    "rotation_last_deg",
    "translation_last_m",
    "without_pose",
    "failed",
    "pose_nees",
    "landmark_nees",
    "iterations",
    "milliseconds",
)
"""Of a row, after what says which run it is."""


def score(block: FlightBlock, method: Method, answers: Answers) -> Columns:
    """One number per run of each of COLUMNS; NaN where a method has nothing to say."""
    if method.solver == "bound":
        columns = _bound_columns(answers)
    else:
        columns = _pose_columns(block, answers)
        if method.solver != "true_model":  # which is told the landmarks
            columns |= _landmark_columns(block, answers)
    columns |= {"iterations": answers.iterations, "milliseconds": 1e3 * answers.seconds}
    return {name: columns.get(name, np.full(len(block.runs), np.nan)) for name in COLUMNS}


def _pose_columns(block: FlightBlock, answers: Answers) -> Columns:
    r, k = answers.T_camera_target.shape[:2]
    T = answers.T_camera_target.reshape(-1, 4, 4)
    T_true = np.tile(block.T_true, (r, 1, 1))
    distance = range_m(T_true)
    rotation, translation = rotation_error_deg(T, T_true), translation_error_m(T, T_true)
    failed = failed_frames(rotation, 100.0 * translation / distance)
    squares = pose_squares(T, T_true, answers.covariances.reshape(-1, 6, 6))
    limit_m = 0.01 * FAILURE_TRANSLATION_PERCENT * distance
    by_run = {
        "rotation_deg": rotation,
        "translation_m": translation,
        "without_pose": np.isnan(rotation).astype(float),
        "failed": failed.astype(float),
        "rotation_penalised_deg": np.where(failed, FAILURE_ROTATION_DEG, rotation),
        "translation_penalised_m": np.where(failed, limit_m, translation),
        "pose_nees": squares / 6.0,
    }
    columns = {name: mean_of_known(values.reshape(r, k)) for name, values in by_run.items()}
    columns["rotation_rms_deg"] = np.sqrt(mean_of_known(rotation.reshape(r, k) ** 2))
    columns["translation_rms_m"] = np.sqrt(mean_of_known(translation.reshape(r, k) ** 2))
    columns["rotation_last_deg"] = rotation.reshape(r, k)[:, -1]
    columns["translation_last_m"] = translation.reshape(r, k)[:, -1]
    return columns


def _landmark_columns(block: FlightBlock, answers: Answers) -> Columns:
    error = answers.X - block.X_true
    distance = np.linalg.norm(error, axis=2)
    columns = {"landmark_m": distance.mean(axis=1), "landmark_rms_m": np.sqrt((distance**2).mean(axis=1))}
    if answers.X_covariance is not None:
        flat = error.reshape(len(error), -1)
        columns["landmark_nees"] = normalised_squares(flat, answers.X_covariance) / flat.shape[1]
    return columns


def _bound_columns(answers: Answers) -> Columns:
    """What an estimator would show whose errors are Gaussian with the least covariance, docs/study.md eq. (2)."""
    assert answers.X_covariance is not None
    n = answers.X.shape[1]
    S, P = answers.covariances, answers.X_covariance.reshape(-1, n, 3, n, 3)
    by_landmark = np.stack([P[:, j, :, j, :] for j in range(n)], axis=1)
    columns: Columns = {}
    for name, unit, scale, blocks in (
        ("rotation", "deg", np.degrees(1.0), S[:, :, 3:, 3:]),
        ("translation", "m", 1.0, S[:, :, :3, :3]),
        ("landmark", "m", 1.0, by_landmark),
    ):
        mean = scale * mean_length(blocks)
        columns[f"{name}_{unit}"] = mean.mean(axis=1)
        columns[f"{name}_rms_{unit}"] = scale * np.sqrt(np.trace(blocks, axis1=2, axis2=3).mean(axis=1))
        columns[f"{name}_last_{unit}"] = mean[:, -1]
    return columns


def pose_squares(T: np.ndarray, T_true: np.ndarray, covariances: np.ndarray) -> np.ndarray:
    """e^T P^-1 e of each pose with e as in docs/bound.md eq. (15), (k,); NaN where there is no pose."""
    ok = np.isfinite(T).all(axis=(1, 2)) & np.isfinite(covariances).all(axis=(1, 2))
    Rt = np.swapaxes(T[ok, :3, :3], 1, 2)
    rho = np.einsum("kij,kj->ki", Rt, T_true[ok, :3, 3] - T[ok, :3, 3])
    phi = Rotation.from_matrix(Rt @ T_true[ok, :3, :3]).as_rotvec()
    squares = np.full(len(T), np.nan)
    squares[ok] = normalised_squares(np.hstack([rho, phi]), covariances[ok])
    return squares


def normalised_squares(errors: np.ndarray, covariances: np.ndarray) -> np.ndarray:
    """e^T P^-1 e row by row, docs/metrics.md eq. (18); NaN where P is not positive definite.

    Correlations are inverted, not covariances, so that metres and radians may be mixed.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        sigma = np.sqrt(np.diagonal(covariances, axis1=1, axis2=2))
        correlations = covariances / (sigma[:, :, None] * sigma[:, None, :])
    usable = np.flatnonzero(np.isfinite(correlations).all(axis=(1, 2)))
    usable = usable[_positive_definite(correlations[usable])]
    scaled = errors[usable] / sigma[usable]
    squares = np.full(len(errors), np.nan)
    squares[usable] = np.einsum("ki,ki->k", scaled, np.linalg.solve(correlations[usable], scaled[:, :, None])[:, :, 0])
    return squares


def _positive_definite(matrices: np.ndarray) -> np.ndarray:
    """Which of them have a Cholesky factor; usually all, which is found out at once."""
    try:
        np.linalg.cholesky(matrices)
    except np.linalg.LinAlgError:
        return np.linalg.eigvalsh(matrices)[:, 0] > 0.0
    return np.ones(len(matrices), dtype=bool)


def mean_length(covariances: np.ndarray) -> np.ndarray:
    """E |e| of e ~ N(0, S) for each S (..., 3, 3), docs/study.md eq. (1).

    The integral is taken over s = tan(theta) in units of the largest standard deviation, by Gauss-Legendre.
    """
    eigenvalues = np.maximum(np.linalg.eigvalsh(covariances), 0.0)
    largest = eigenvalues[..., -1:]
    ratios = eigenvalues / np.where(largest > 0.0, largest, 1.0)
    nodes, weights = np.polynomial.legendre.leggauss(48)
    theta = 0.25 * np.pi * (nodes + 1.0)
    s = np.tan(theta)
    remains = 1.0 / np.sqrt((1.0 + 2.0 * ratios[..., None] * s**2).prod(axis=-2))
    integral = (0.25 * np.pi * weights * (1.0 - remains) / np.sin(theta) ** 2).sum(axis=-1)
    return np.sqrt(largest[..., 0] / np.pi) * integral


def mean_of_known(values: np.ndarray) -> np.ndarray:
    """Mean of each row over what is not NaN; NaN where all is."""
    known = ~np.isnan(values)
    counts = known.sum(axis=1)
    sums = np.where(known, values, 0.0).sum(axis=1)
    return np.where(counts > 0, sums / np.maximum(counts, 1), np.nan)
