# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Which estimate belongs to which truth, docs/metrics.md section 1."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fairlead.types import Estimate, TruthPose

TOLERANCE_NS = 1_000_000
"""Largest difference of two stamps that still mean the same image [ns]."""


@dataclass(frozen=True, kw_only=True)
class Matching:
    """Pairs of truth and estimate, in the order of the estimates; each is used once at most."""

    pairs: tuple[tuple[int, int], ...]
    """(index of the truth, index of the estimate)."""
    n_truth: int
    n_estimates: int
    n_by_nearest: int
    """Pairs whose stamps differ."""
    largest_offset_ns: int
    """Largest difference of stamps within a pair [ns]."""

    @property
    def n_matched(self) -> int:
        """Number of pairs: the frames that errors are computed from."""
        return len(self.pairs)

    @property
    def n_truth_left_over(self) -> int:
        """True poses to which the run has no line at all: not judged, so they are said."""
        return self.n_truth - self.n_matched


def match_by_stamp(
    truth: Sequence[TruthPose], estimates: Sequence[Estimate], *, tolerance_ns: int = TOLERANCE_NS
) -> Matching:
    """Pair by equal frame and stamp first, then by the nearest stamp within `tolerance_ns`, closest pairs first.

    Stamps are whole nanoseconds and compared as such. Raises ValueError for a negative tolerance.
    """
    if tolerance_ns < 0:
        raise ValueError(f"tolerance_ns: expected >= 0, got {tolerance_ns}")
    exact = {(estimate.frame, estimate.stamp_ns): index for index, estimate in reversed(list(enumerate(estimates)))}
    partner: dict[int, int] = {}
    for index, pose in enumerate(truth):
        found = exact.pop((pose.frame, pose.stamp_ns), None)
        if found is not None:
            partner[found] = index
    _match_nearest(truth, estimates, tolerance_ns, partner)
    offsets = [abs(truth[i].stamp_ns - estimates[j].stamp_ns) for j, i in partner.items()]
    return Matching(
        pairs=tuple((partner[j], j) for j in sorted(partner)),
        n_truth=len(truth),
        n_estimates=len(estimates),
        n_by_nearest=sum(offset > 0 for offset in offsets),
        largest_offset_ns=max(offsets, default=0),
    )


def _match_nearest(
    truth: Sequence[TruthPose], estimates: Sequence[Estimate], tolerance_ns: int, partner: dict[int, int]
) -> None:
    """Add to `partner` (estimate -> truth) what is left, closest stamps first."""
    taken = set(partner.values())
    free_truth = [i for i in range(len(truth)) if i not in taken]
    free_estimates = sorted((j for j in range(len(estimates)) if j not in partner), key=lambda j: estimates[j].stamp_ns)
    stamps = np.array([estimates[j].stamp_ns for j in free_estimates], dtype=np.int64)
    candidates: list[tuple[int, int, int]] = []
    for i in free_truth:
        first = int(np.searchsorted(stamps, truth[i].stamp_ns - tolerance_ns, side="left"))
        last = int(np.searchsorted(stamps, truth[i].stamp_ns + tolerance_ns, side="right"))
        candidates += [(abs(truth[i].stamp_ns - int(stamps[k])), i, free_estimates[k]) for k in range(first, last)]
    for _, i, j in sorted(candidates):
        if j not in partner and i not in taken:
            partner[j] = i
            taken.add(i)
