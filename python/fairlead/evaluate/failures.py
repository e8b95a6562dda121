# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Coverage, failures, and a mean that a method cannot improve by staying silent, docs/metrics.md eq. (5)-(7)."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool

from fairlead.evaluate.summary import Series
from fairlead.types import Estimate

FAILURE_ROTATION_DEG = 30.0
"""A larger rotation error is a failure [deg]."""
FAILURE_TRANSLATION_PERCENT = 25.0
"""A larger translation error is a failure [% of range]."""
FAILURE_POSITION_PERCENT = FAILURE_TRANSLATION_PERCENT + 200.0 * float(np.sin(np.radians(FAILURE_ROTATION_DEG / 2.0)))
"""The largest error of the camera's position that the two limits above allow [% of range], docs/metrics.md eq. (6)."""

Flags = Bool[np.ndarray, " k"]


@dataclass(frozen=True, kw_only=True)
class Coverage:
    """How many frames got a pose, docs/metrics.md eq. (7)."""

    n_frames: int
    n_ok: int
    n_resets: int
    """Jumps that the estimator itself announced."""
    first_ok: int | None
    """Position in the run of the first frame with a pose; None if no frame has one."""
    reasons: tuple[tuple[str, int], ...]
    """Why there was no pose, and how often, most frequent first."""
    doubts: tuple[tuple[str, int], ...]
    """What the data contradict, and in how many frames that have a pose, docs/estimator.md section 8."""

    @property
    def rate(self) -> float:
        """Share of frames with a pose [-]; NaN of an empty run."""
        return self.n_ok / self.n_frames if self.n_frames else float("nan")


@dataclass(frozen=True, kw_only=True)
class Failures:
    """Frames judged against truth that have no pose or a useless one, docs/metrics.md eq. (5)."""

    n_frames: int
    n_without_pose: int
    n_wrong: int
    """With a pose, but beyond a limit: the dangerous kind."""

    @property
    def rate(self) -> float:
        """Share of failures [-]; NaN where nothing was judged."""
        return (self.n_without_pose + self.n_wrong) / self.n_frames if self.n_frames else float("nan")


def coverage(estimates: Sequence[Estimate]) -> Coverage:
    """Count poses and the reasons for their absence."""
    ok = [estimate.ok for estimate in estimates]
    reasons = Counter(estimate.reason or estimate.status for estimate in estimates if not estimate.ok)
    return Coverage(
        n_frames=len(ok),
        n_ok=sum(ok),
        n_resets=estimates[-1].reset_counter - estimates[0].reset_counter if estimates else 0,
        first_ok=ok.index(True) if True in ok else None,
        reasons=tuple(reasons.most_common()),
        doubts=tuple(Counter(estimate.reason for estimate in estimates if estimate.in_doubt).most_common()),
    )


def failed_frames(rotation_deg: Series, translation_percent: Series) -> Flags:
    """No pose (NaN), or beyond a limit, docs/metrics.md eq. (5)."""
    within = (rotation_deg <= FAILURE_ROTATION_DEG) & (translation_percent <= FAILURE_TRANSLATION_PERCENT)
    return ~within


def penalised_mean(errors: Series, failed: Flags, limits: Series) -> float:
    """Mean over all judged frames in which a failed one counts with the limit, docs/metrics.md eq. (6).

    NaN where nothing was judged.
    """
    if not errors.size:
        return float("nan")
    return float(np.where(failed, limits, errors).mean())
