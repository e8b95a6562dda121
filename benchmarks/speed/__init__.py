# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Time of the window solve and of `update()`, next to Ceres, GTSAM and SciPy on the same cost from the same start."""
