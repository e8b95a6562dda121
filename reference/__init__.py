# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Slow numpy/scipy oracle: the posterior, its optimum and covariance, and the Bayesian bound (docs/bound.md).

Shares no code and no formula with what it judges: a view is unknown here through its camera centre c (target axes) and
a left rotation vector w, p_camera = exp(w) R (X - c), never through a right perturbation of T_camera_target. Only tests
and benchmarks import it.
"""
