# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The autopilots whose rules are known, docs/mavlink.md section 3."""

from typing import Literal

Autopilot = Literal["px4", "ardupilot"]
