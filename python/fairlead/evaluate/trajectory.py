# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The path of the camera in the target frame: absolute and relative error, docs/metrics.md eq. (22)-(23).

Source: Sturm et al. 2012, A benchmark for the evaluation of RGB-D SLAM systems, section IV.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from fairlead import geometry
from fairlead.evaluate.pose import camera_positions, rotation_error_deg
from fairlead.evaluate.summary import Summary, summarise
from fairlead.types import Poses

Steps = Float64[np.ndarray, " k-1"]
"""One number per pair of neighbouring frames."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TrajectoryErrors:
    """Over the judged frames that have a pose. None where the path does not determine the alignment."""

    ate_m: Summary
    """Of the camera's position, nothing moved [m]."""
    ate_se3_m: Summary | None
    """After the best rigid motion of the estimated path onto the true one [m]."""
    ate_sim3_m: Summary | None
    """After the best similarity [m]."""
    rpe_m: Summary | None
    """Of the motion between neighbouring frames [m]."""
    rpe_deg: Summary | None
    """Of the rotation between neighbouring frames [deg]."""


def trajectory_errors(T_estimated: Poses, T_true: Poses) -> TrajectoryErrors | None:
    """ATE and RPE of matched poses, all finite, in order of time. None for no poses."""
    if not len(T_true):
        return None
    metres, degrees = relative_errors(T_estimated, T_true)
    return TrajectoryErrors(
        ate_m=summarise(np.linalg.norm(camera_positions(T_estimated) - camera_positions(T_true), axis=1)),
        ate_se3_m=_aligned(T_estimated, T_true, with_scale=False),
        ate_sim3_m=_aligned(T_estimated, T_true, with_scale=True),
        rpe_m=summarise(metres) if metres.size else None,
        rpe_deg=summarise(degrees) if degrees.size else None,
    )


def relative_errors(T_estimated: Poses, T_true: Poses) -> tuple[Steps, Steps]:
    """|trans E_k| [m] and angle of E_k [deg], E_k = (Q_k^-1 Q_k+1)^-1 (P_k^-1 P_k+1), docs/metrics.md eq. (23).

    Q and P are T_target_camera, true and estimated; k and k+1 are neighbours among the poses given.
    """
    steps = T_estimated[:-1] @ np.linalg.inv(T_estimated[1:])
    steps_true = T_true[:-1] @ np.linalg.inv(T_true[1:])
    residual = np.linalg.inv(steps_true) @ steps
    return np.linalg.norm(residual[:, :3, 3], axis=1), rotation_error_deg(steps, steps_true)


def _aligned(T_estimated: Poses, T_true: Poses, *, with_scale: bool) -> Summary | None:
    path, path_true = camera_positions(T_estimated), camera_positions(T_true)
    align = geometry.align_similarity if with_scale else geometry.align_rigid
    try:
        similarity = align(path_true, path)
    except ValueError:
        return None
    return summarise(np.linalg.norm(similarity.apply(path) - path_true, axis=1))
