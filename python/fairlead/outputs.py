# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Which sinks a run was asked for, beside its folder."""

from collections.abc import Iterator
from pathlib import Path

from fairlead.config import TrackConfig, UsageError
from fairlead.io.mesh import Mesh, load_mesh
from fairlead.io.poses import read_truth
from fairlead.sinks.sink import OutcomeSink
from fairlead.types import Camera, PoseEstimator, Target


def open_outputs(
    config: TrackConfig, target: Target, camera: Camera, estimator: PoseEstimator
) -> Iterator[OutcomeSink]:
    """Each sink as soon as it is open. Raises InputError, UsageError, OSError."""
    if config.overlay is not None:
        yield _overlay(config.overlay, config.truth, target, camera, estimator)
    if config.viewer or config.rrd is not None:
        from fairlead.sinks.viewer import ViewerSink

        mesh = _mesh(target)
        yield ViewerSink(target, camera, estimator, mesh=mesh, rrd=config.rrd, live=config.viewer)
    if config.mcap is not None:
        from fairlead.sinks.ros.mcap import McapSink

        yield McapSink(config.mcap, camera=camera.name, target=target.name)
    if config.mavlink is not None:
        yield _mavlink(config, config.mavlink, target)
    if config.parquet:
        from fairlead.sinks.parquet import ParquetSink

        yield ParquetSink(config.output / "poses.parquet")


def check_outputs(config: TrackConfig, inputs: list[Path]) -> None:
    """Raises UsageError where a sink would write over something that is read, or has another kind of name."""
    files = (("--overlay", config.overlay, ".mkv"), ("--mcap", config.mcap, ".mcap"), ("--rrd", config.rrd, ".rrd"))
    for option, path, suffix in files:
        if path is None:
            continue
        if path.suffix != suffix:
            raise UsageError(f"{option}: expected a file that ends in {suffix}, got {path}")
        if path.resolve() in {each.resolve() for each in inputs}:
            raise UsageError(f"{option}: {path} is read: it would be written over")
    if config.mavlink is None:
        return
    if config.autopilot is None or config.mount is None:
        raise UsageError("--mavlink: expected --autopilot and --mount too")
    if not config.mavlink_systems or not all(0 < system < 256 for system in config.mavlink_systems):
        raise UsageError(f"--mavlink-systems: expected ids from 1 to 255, got {config.mavlink_systems}")
    if not 0.0 < config.mavlink_rate <= 100.0:
        raise UsageError(f"--mavlink-rate: expected above 0, up to 100, got {config.mavlink_rate}")


def _mavlink(config: TrackConfig, address: str, target: Target) -> OutcomeSink:
    from fairlead.io.mount import load_mount
    from fairlead.sinks.mavlink import MavlinkOptions, MavlinkSink
    from fairlead.sinks.mavlink.link import Link, load_key
    from fairlead.sinks.mavlink.transport import open_transport

    assert config.autopilot is not None
    assert config.mount is not None
    mount = load_mount(config.mount)
    key = None if config.mavlink_key is None else load_key(config.mavlink_key)
    live = isinstance(config.source, str)
    options = MavlinkOptions(autopilot=config.autopilot, rate_hz=config.mavlink_rate, live=live)
    link = Link(open_transport(address), systems=config.mavlink_systems, key=key)
    return MavlinkSink(link, target, mount, options)


def _mesh(target: Target) -> Mesh | None:
    return None if target.mesh is None else load_mesh(target.mesh)


def _overlay(path: Path, truth: Path | None, target: Target, camera: Camera, estimator: PoseEstimator) -> OutcomeSink:
    from fairlead.sinks.overlay import OverlayPainter, OverlaySink

    mesh = _mesh(target)
    poses = {} if truth is None else {each.frame: each.T_camera_target for each in read_truth(truth)}
    return OverlaySink(path, OverlayPainter(target, camera, estimator, mesh=mesh, truth=poses))
