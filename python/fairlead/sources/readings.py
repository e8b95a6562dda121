# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What other sensors said, handed to the tracker as the views come."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from fairlead.tracker import Tracker
from fairlead.types import AttitudeReading, RangeReading, View

Reading = RangeReading | AttitudeReading


@dataclass(kw_only=True)
class SensorReadings:
    """Ranges and attitudes of a recording, those that can be used; each is told before the first view after it."""

    ranges: Sequence[RangeReading] = ()
    attitudes: Sequence[AttitudeReading] = ()
    _waiting: list[Reading] = field(init=False)

    def __post_init__(self) -> None:
        self.ranges = tuple(filter(_usable, self.ranges))
        self.attitudes = tuple(filter(_usable, self.attitudes))
        readings: list[Reading] = [*self.ranges, *self.attitudes]
        self._waiting = sorted(readings, key=lambda each: each.stamp_ns, reverse=True)

    def tell(self, tracker: Tracker, view: View) -> None:
        """Everything up to the view's stamp. Raises ValueError for a landmark that the target does not have."""
        while self._waiting and self._waiting[-1].stamp_ns <= view.stamp_ns:
            reading = self._waiting.pop()
            if isinstance(reading, RangeReading):
                tracker.add_range(reading.stamp_ns, reading.range_m, reading.sigma_m, reading.landmark)
            else:
                tracker.add_attitude(reading.stamp_ns, reading.R_world_camera, reading.sigma_rad)


def _usable(reading: Reading) -> bool:
    if isinstance(reading, AttitudeReading):
        return bool(np.isfinite(reading.sigma_rad) and reading.sigma_rad >= 0.0)
    numbers = np.array([reading.range_m, reading.sigma_m])
    return bool(np.isfinite(numbers).all() and (numbers > 0.0).all())
