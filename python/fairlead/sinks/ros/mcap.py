# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""An MCAP file of ROS 2 messages that can be read up to the last frame when the process is killed."""

import re
from pathlib import Path
from typing import Any

from fairlead.io.errors import InputError
from fairlead.sinks.ros.messages import (
    DIAGNOSTICS,
    POSE,
    TRANSFORMS,
    definition,
    diagnostic_message,
    pose_message,
    transform_message,
)
from fairlead.sinks.sink import Outcome

TOPICS = {"/fairlead/pose": POSE, "/tf": TRANSFORMS, "/diagnostics": DIAGNOSTICS}


class McapSink:
    """/fairlead/pose, /tf and /diagnostics, docs/ros.md. Frames without a pose leave a diagnostic message only.

    Parameters
    ----------
    camera, target : names; what ROS does not allow in the name of a frame becomes an underscore

    Raises InputError without the extra `ros`; OSError where the file cannot be written.
    """

    def __init__(self, path: Path, *, camera: str, target: str) -> None:
        try:
            from mcap.writer import CompressionType, Writer
        except ImportError as error:
            raise InputError(path, "writing MCAP needs the extra: pip install 'fairlead[ros]'") from error
        self._camera, self._target = frame_name(camera), frame_name(target)
        self._name = target
        self._stream = path.open("wb")
        # A chunk a message: each is on its way to the disk, with its index, before the next one is made.
        self._writer: Any = Writer(self._stream, chunk_size=1, compression=CompressionType.NONE)
        self._writer.start(profile="ros2", library="fairlead")
        self._channels: dict[str, int] = {}
        for topic, kind in TOPICS.items():
            schema = self._writer.register_schema(kind, "ros2msg", definition(kind).encode())
            self._channels[topic] = self._writer.register_channel(topic, "cdr", schema)
        self._closed = False

    def write(self, outcome: Outcome) -> None:
        """Append the messages of one frame."""
        estimate = outcome.estimate
        if estimate.ok:
            self._append("/fairlead/pose", pose_message(estimate, self._camera), estimate.stamp_ns)
            self._append("/tf", transform_message(estimate, self._camera, self._target), estimate.stamp_ns)
        self._append("/diagnostics", diagnostic_message(estimate, self._name), estimate.stamp_ns)
        self._stream.flush()

    def _append(self, topic: str, data: bytes, stamp_ns: int) -> None:
        log_ns = max(stamp_ns, 0)
        self._writer.add_message(self._channels[topic], log_time=log_ns, data=data, publish_time=log_ns)

    def close(self) -> None:
        """Write the summary and close the file; safe to call twice."""
        if self._closed:
            return
        self._closed = True
        try:
            self._writer.finish()
        finally:
            self._stream.close()


def frame_name(text: str) -> str:
    """A name of a ROS frame: letters, digits and underscores, not beginning with a digit."""
    name = re.sub(r"[^A-Za-z0-9_]", "_", text)
    return name if re.match(r"[A-Za-z]", name) else f"f_{name}"
