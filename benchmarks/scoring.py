# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Errors of one simulated flight, all views at once, docs/bound.md eq. (15)-(17)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from fairlead.types import Estimate, Points3, Poses, Target


@dataclass(frozen=True, kw_only=True, eq=False)
class Answer:
    """What a method says about one flight."""

    T: Poses
    """(k, 4, 4) T_camera_target, NaN where there is no pose."""
    X: Points3
    """(n, 3) [m]."""
    pose_covariances: np.ndarray | None = None
    """(k, 6, 6) of xi."""
    landmark_covariance: np.ndarray | None = None
    """(3n, 3n) [m^2]."""


def answer_of(estimates: Sequence[Estimate], model: Target) -> Answer:
    """Of an estimator with a model prior: its poses and its model, with their covariances."""
    return Answer(
        T=np.stack([estimate.T_camera_target for estimate in estimates]),
        X=model.positions,
        pose_covariances=np.stack([estimate.covariance for estimate in estimates]),
        landmark_covariance=model.covariance,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Scores:
    """Errors of one answer; NaN where there is no pose, or no covariance."""

    rotation_deg: np.ndarray
    """(k,) angle of R_est^T R_true."""
    translation_m: np.ndarray
    """(k,) |t_est - t_true|."""
    landmark_m: np.ndarray
    """(n,) |X_est - X_true|, raw: no alignment."""
    pose_nees: np.ndarray
    """(k,) e^T P^-1 e, 6 degrees of freedom."""
    landmark_nees: float
    """e^T P^-1 e, 3n degrees of freedom."""


def pose_errors(T_est: Poses, T_true: Poses) -> np.ndarray:
    """e = (R_est^T (t_true - t_est), Log(R_est^T R_true)), (k, 6) [m, rad], docs/bound.md eq. (15)."""
    Rt = np.swapaxes(T_est[:, :3, :3], 1, 2)
    phi = Rotation.from_matrix(Rt @ T_true[:, :3, :3]).as_rotvec()
    return np.hstack([np.einsum("kij,kj->ki", Rt, T_true[:, :3, 3] - T_est[:, :3, 3]), phi])


def score(answer: Answer, T_true: Poses, X_true: Points3) -> Scores:
    """Compare one answer with the truth."""
    k, ok = len(T_true), np.isfinite(answer.T).all(axis=(1, 2))
    rotation, translation, nees = (np.full(k, np.nan), np.full(k, np.nan), np.full(k, np.nan))
    if ok.any():
        error = pose_errors(answer.T[ok], T_true[ok])
        rotation[ok] = np.degrees(np.linalg.norm(error[:, 3:], axis=1))
        translation[ok] = np.linalg.norm(error[:, :3], axis=1)
        if answer.pose_covariances is not None:
            solved = np.linalg.solve(answer.pose_covariances[ok], error[:, :, None])[:, :, 0]
            nees[ok] = np.einsum("ki,ki->k", error, solved)
    off = answer.X - X_true
    landmark_nees = np.nan
    if answer.landmark_covariance is not None:
        landmark_nees = float(off.ravel() @ np.linalg.solve(answer.landmark_covariance, off.ravel()))
    return Scores(
        rotation_deg=rotation,
        translation_m=translation,
        landmark_m=np.linalg.norm(off, axis=1),
        pose_nees=nees,
        landmark_nees=landmark_nees,
    )
