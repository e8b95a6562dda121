# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""How alike a network's errors are within a picture. docs/networks.md section 5."""

from collections.abc import Iterator

import numpy as np

from fairlead.design_effect import design_effect
from fairlead.io.network_card import Calibration
from fairlead.train.calibration import covariances
from fairlead.train.findings import Findings


def measured_design_effect(findings: Findings, calibration: Calibration, landmarks: int) -> float:
    """Of what a tracker would be told of and is visible, with calibrated covariances; NaN if there is too little."""
    told = (findings.visible > calibration.visible_threshold) & (findings.visibility == 2)
    return design_effect(_pictures(findings.where(told), calibration, landmarks))


def _pictures(
    rows: Findings, calibration: Calibration, landmarks: int
) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    S = covariances(rows, calibration, landmarks)
    _, number = np.unique(np.stack([rows.condition, rows.picture]), axis=1, return_inverse=True)
    for k in range(int(number.max(initial=-1)) + 1):
        of = number == k
        yield rows.error[of], S[of], rows.jacobian[of]
