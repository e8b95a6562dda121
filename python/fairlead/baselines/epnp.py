# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""EPnP frame by frame on the model as it was given: what most people do, docs/baselines.md section 2."""

from fairlead.baselines.observed import observed, plain
from fairlead.baselines.single_view import solve_view, tracked
from fairlead.tracker import LandmarkIndex
from fairlead.types import Camera, Estimate, Target, View, no_pose


class EpnpTracker:
    """Each view for itself; the model never changes.

    EPnP as published, without a search for outliers and without refinement; flat landmarks go to IPPE and SQPnP too,
    where EPnP fails. The covariance is that of the told pixel errors on an exact model, docs/baselines.md eq. (1): what
    a user of EPnP has, and too small where the model is wrong.

    Raises ValueError for fewer than four landmarks.
    """

    def __init__(self, target: Target, camera: Camera) -> None:
        if len(target.landmarks) < 4:
            raise ValueError(f"target: expected at least 4 landmarks, got {len(target.landmarks)}")
        self._target = target
        self._camera = plain(camera)
        self._index = LandmarkIndex(target.landmarks)

    def update(self, view: View) -> Estimate:
        """Status tracking, or lost with reason too_few or degenerate. ValueError for an unknown landmark only."""
        seen = observed(view, self._index)
        found = solve_view(seen, self._target.positions, self._camera, refined=False)
        if isinstance(found, str):
            return no_pose(view, "lost", found)
        return tracked(view, seen, found, self._target.landmarks)

    @property
    def model(self) -> Target:
        """The target as it was given."""
        return self._target
