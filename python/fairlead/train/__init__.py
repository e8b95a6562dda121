# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Networks that find landmarks: data, training, calibration, export. docs/networks.md. The only place with torch."""
