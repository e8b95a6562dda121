# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Estimates as ROS 2 messages in an MCAP file, docs/ros.md."""
