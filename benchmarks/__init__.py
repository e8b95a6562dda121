# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What fairlead is measured by: accuracy against baselines and the Bayesian bound, and speed against other solvers."""
