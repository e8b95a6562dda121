# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Estimates for autopilots: LANDING_TARGET and TARGET_RELATIVE, docs/mavlink.md."""

from fairlead.sinks.mavlink.sink import MavlinkOptions, MavlinkSink

__all__ = ["MavlinkOptions", "MavlinkSink"]
