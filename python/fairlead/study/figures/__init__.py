# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of a study; each method looks the same in all of them."""

from fairlead.study.figures.cost import draw_cost
from fairlead.study.figures.grid import draw_gain
from fairlead.study.figures.sweep import draw_sensitivity, draw_sweep

__all__ = ["draw_cost", "draw_gain", "draw_sensitivity", "draw_sweep"]
