# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Landmark networks, docs/networks.md: heat (the default), RTMPose and PP-TinyPose."""
