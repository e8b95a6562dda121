# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""How alike a detector's errors are."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Correlation:
    """Errors of two views are alike by exp(-1) for each of these between them, docs/motion.md eq. (12).

    0: makes no difference; all three 0: errors are new in every view.
    """

    time_s: float = 0.0
    angle_rad: float = 0.0
    """Turn of the line of sight in the target frame."""
    log_range: float = 0.0
    """Change of the logarithm of the range."""
    design_effect: float = 1.0
    """The pose of a view errs so many times more, squared, since its landmarks err alike, docs/motion.md eq. (16)."""
