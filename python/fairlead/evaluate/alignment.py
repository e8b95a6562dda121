# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Take the gauge out: move the estimated model onto the true one, the poses with it, docs/metrics.md eq. (8)-(9)."""

from typing import Literal

import numpy as np

from fairlead import geometry
from fairlead.types import Points3, Poses, Target

Alignment = Literal["raw", "se3", "sim3"]
ALIGNMENTS: tuple[Alignment, ...] = ("raw", "se3", "sim3")

_IDENTITY = geometry.Similarity(scale=1.0, R_a_b=np.eye(3), t_a_b=np.zeros(3))


def common_landmarks(estimated: Target, true: Target) -> tuple[tuple[str, ...], Points3, Points3]:
    """Names in both models, in the order of the estimated one, with their positions in each [m]."""
    place = {name: index for index, name in enumerate(true.landmarks)}
    rows = [index for index, name in enumerate(estimated.landmarks) if name in place]
    names = tuple(estimated.landmarks[index] for index in rows)
    return names, estimated.positions[rows], true.positions[[place[name] for name in names]]


def model_alignment(estimated: Points3, true: Points3, alignment: Alignment) -> geometry.Similarity | None:
    """S that minimises sum |X_true - S(X_est)|^2 (Umeyama 1991), docs/metrics.md eq. (8).

    "raw" moves nothing. None where the landmarks do not determine it: fewer than three, or on a line.
    """
    if alignment == "raw":
        return _IDENTITY
    align = geometry.align_rigid if alignment == "se3" else geometry.align_similarity
    try:
        return align(true, estimated)
    except ValueError:
        return None


def align_poses(T_camera_target: Poses, similarity: geometry.Similarity) -> Poses:
    """Poses that belong to the moved model S(X) and give the same image, docs/metrics.md eq. (9).

    R' = R R_S^T, t' = s t - R' t_S, so that R' S(X) + t' = s (R X + t): every ray stays.
    """
    aligned = T_camera_target.copy()
    R = T_camera_target[:, :3, :3] @ similarity.R_a_b.T
    aligned[:, :3, :3] = R
    aligned[:, :3, 3] = similarity.scale * T_camera_target[:, :3, 3] - R @ similarity.t_a_b
    return aligned
