# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""How alike the errors of the landmarks of one picture are, by what they do to its pose. docs/networks.md section 5."""

import numpy as np

from fairlead.io.network_card import Calibration
from fairlead.train.calibration import squared
from fairlead.train.findings import Findings

GATE = 18.42
"""Squares of whitened errors above this are gross errors, which an estimator leaves out; chi-square, 99.99 %."""
FEWEST = 6
"""Landmarks of a picture that its pose is asked of."""


def design_effect(findings: Findings, calibration: Calibration, landmarks: int) -> float:
    """kappa = sum over pictures of q_k / 6 over that of s_k / 2n, at least 1; docs/networks.md eq. (7).

    q = g^T H^-1 g with H = sum J^T S^-1 J and g = sum J^T S^-1 e: by how much a picture's errors move its pose, squared
    and whitened; 6 if the errors are independent. s = sum e^T S^-1 e: 2n if the covariances are right. NaN if no
    picture has FEWEST landmarks.
    """
    scale = np.broadcast_to(np.array(calibration.scale), (landmarks,))[findings.landmark]
    S = scale[:, None, None] * findings.covariance + calibration.floor_px**2 * np.eye(2)
    s = squared(findings, calibration, landmarks)
    taken = (findings.visible > calibration.visible_threshold) & (findings.visibility == 2) & (s < GATE)
    _, picture = np.unique(np.stack([findings.condition, findings.picture]), axis=1, return_inverse=True)
    moved, off = 0.0, 0.0
    for k in np.unique(picture[taken]):
        rows = np.flatnonzero(taken & (picture == k))
        if len(rows) < FEWEST:
            continue
        WJ = np.linalg.solve(S[rows], findings.jacobian[rows])
        H = np.einsum("mai,maj->ij", findings.jacobian[rows], WJ)
        g = np.einsum("mai,ma->i", WJ, findings.error[rows])
        unit = 1.0 / np.sqrt(np.diag(H))  # metres and radians differ by far in size
        moved += (unit * g) @ np.linalg.solve(unit[:, None] * H * unit, unit * g) / 6.0
        off += s[rows].mean() / 2.0
    return max(1.0, float(moved / off)) if off > 0.0 else float("nan")
