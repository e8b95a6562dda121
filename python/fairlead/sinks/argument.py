# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The sinks beside the folder of a run as they stand on the command line."""

from dataclasses import dataclass
from pathlib import Path

from fairlead.sinks.autopilots import Autopilot


@dataclass(frozen=True, kw_only=True)
class SinkOptions:
    """What `track` writes, shows and tells beside its folder."""

    overlay: Path | None = None
    """Video (.mkv) of the images with silhouette, landmarks and their uncertainty drawn over them."""
    viewer: bool = False
    """Show it while it runs (rerun)."""
    rrd: Path | None = None
    """File (.rrd) of what the viewer shows, to look at later with `rerun FILE`."""
    mcap: Path | None = None
    """ROS 2 messages of every frame: /fairlead/pose, /tf, /diagnostics."""
    mavlink: str | None = None
    """Autopilot to tell: udpout:127.0.0.1:14550, udpin:HOST:PORT, tcp:HOST:PORT, /dev/ttyACM0:921600; then --autopilot
    and --mount too."""
    autopilot: Autopilot | None = None
    """Which rules it follows."""
    mount: Path | None = None
    """mount.toml: where the camera sits on the vehicle."""
    mavlink_key: Path | None = None
    """File with the secret that messages are signed with: 32 bytes or 64 hexadecimal digits."""
    mavlink_systems: tuple[int, ...] = (1,)
    """System ids that are listened to; the first one is the vehicle."""
    mavlink_rate: float = 20.0
    """Estimates sent at most [1/s]."""
    parquet: bool = False
    """Write poses.parquet at the end, too."""
