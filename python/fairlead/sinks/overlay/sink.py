# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The overlay as a video file."""

from pathlib import Path

from fairlead.sinks.overlay.picture import OverlayPainter
from fairlead.sinks.sink import Outcome
from fairlead.video import VideoWriter


class OverlaySink:
    """A Matroska file that can be played up to the last frame when the process is killed."""

    def __init__(self, path: Path, painter: OverlayPainter) -> None:
        self._painter = painter
        self._writer = VideoWriter(path)

    def write(self, outcome: Outcome) -> None:
        """Append one picture."""
        self._writer.write(self._painter.paint(outcome), outcome.estimate.stamp_ns)

    def close(self) -> None:
        """Finish the file."""
        self._writer.close()
