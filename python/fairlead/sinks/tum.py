# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""trajectory.tum as a sink."""

from pathlib import Path

from fairlead.io.tum import tum_line
from fairlead.types import Estimate


class TumSink:
    """The camera in the target frame; estimates without a pose are left out."""

    def __init__(self, path: Path) -> None:
        self._stream = path.open("wb", buffering=0)

    def write(self, estimate: Estimate) -> None:
        """Append one line."""
        if estimate.ok:
            self._stream.write(tum_line(estimate.stamp_ns, estimate.T_camera_target).encode())

    def close(self) -> None:
        """Close the file."""
        self._stream.close()
