# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What both ways share: the answer, and why there is none."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fairlead.tracker import Refinement
from fairlead.types import Target, View


class BootstrapError(ValueError):
    """The views do not determine a target. One line that says what is missing."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Bootstrapped:
    """A target from nothing but views."""

    target: Target
    """Landmarks in the frame of docs/your-own-target.md section 4, with their covariance."""
    views: int
    """That got a pose."""
    reprojection_rms_px: float
    left_out: tuple[str, ...]
    """Landmarks that too few views show."""


def bootstrapped(target: Target, refinement: Refinement, seen: set[str]) -> Bootstrapped:
    """The answer of a batch that converged. Raises BootstrapError for one whose residuals say that it is wrong."""
    posed = sum(estimate.ok for estimate in refinement.estimates)
    rms = refinement.reprojection_rms_px
    if posed < 2 or not np.isfinite(rms):
        raise BootstrapError(f"expected views that agree on one rigid target, got {posed} that do")
    left_out = tuple(sorted(seen - set(target.landmarks)))
    return Bootstrapped(target=target, views=posed, reprojection_rms_px=rms, left_out=left_out)


def only(views: Sequence[View], landmarks: set[str]) -> list[View]:
    """The views with these landmarks only, each once and with finite pixels."""
    kept: list[View] = []
    for view in views:
        first = {name: row for row, name in reversed(list(enumerate(view.landmarks)))}
        rows = [
            row
            for name, row in sorted(first.items(), key=lambda item: item[1])
            if name in landmarks and np.isfinite(view.pixels[row]).all() and np.isfinite(view.covariances[row]).all()
        ]
        names = tuple(view.landmarks[row] for row in rows)
        pixels, covariances = view.pixels[rows].reshape(-1, 2), view.covariances[rows].reshape(-1, 2, 2)
        kept.append(
            View(frame=view.frame, stamp_ns=view.stamp_ns, landmarks=names, pixels=pixels, covariances=covariances)
        )
    return kept
