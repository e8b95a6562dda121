# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Files <-> types, one module per format. Units are converted here and nowhere else."""
