# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What the estimator believes, drawn over what the camera saw, docs/pipeline.md section 3."""

from fairlead.sinks.overlay.picture import OverlayPainter
from fairlead.sinks.overlay.sink import OverlaySink

__all__ = ["OverlayPainter", "OverlaySink"]
