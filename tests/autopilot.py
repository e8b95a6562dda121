# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""An autopilot on the loopback that rolls, pitches, yaws and moves, and hears with PX4's or with ArduPilot's rules."""

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from pymavlink.dialects.v20 import common

from fairlead.geometry import exp_se3, inverse
from fairlead.io.mount import Mount, rotation_from_euler
from fairlead.sinks.autopilots import Autopilot
from fairlead.sinks.mavlink import MavlinkOptions, MavlinkSink
from fairlead.sinks.mavlink.dialect import messages_in
from fairlead.sinks.mavlink.link import Link
from fairlead.sinks.mavlink.transport import open_transport
from fairlead.sinks.sink import Outcome
from fairlead.types import Target
from tests.outcomes import estimate, no_view

AHEAD_NS = 7_300_000_000_000
"""What the autopilot's clock is ahead of this machine's."""
R0 = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
T_BODY_CAMERA = np.eye(4)
T_BODY_CAMERA[:3] = np.column_stack([R0, [0.1, 0.0, 0.3]])
MOUNT = Mount(T_carrier_camera=T_BODY_CAMERA)
T_NED_TARGET = exp_se3(np.array([40.0, -12.0, -3.0, 0.1, 0.05, 1.2]))
KEY = bytes(range(32))
PERIOD_S = 0.03


def attitude(at_s: float) -> np.ndarray:
    return np.array([0.3 * np.sin(1.3 * at_s), 0.2 * np.cos(0.9 * at_s), 0.5 * at_s])


def position(at_s: float) -> np.ndarray:
    return np.array([35.0 + 3.0 * np.sin(0.7 * at_s), -10.0 + at_s, -30.0 + 2.0 * np.cos(at_s)])


class Autopilot9:
    """Sends its state at 50 Hz from the port, answers TIMESYNC, keeps every valid message with its time."""

    def __init__(self, *, key: bytes | None = None, system: int = 1) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.settimeout(0.004)
        self.port: int = self.socket.getsockname()[1]
        self.start_ns = time.monotonic_ns()
        self.mav: Any = common.MAVLink(None, srcSystem=system, srcComponent=1)
        if key is not None:
            signing = self.mav.signing
            signing.secret_key, signing.sign_outgoing, signing.timestamp = (
                key,
                True,
                int((time.time() - 1_420_070_400) * 1e5),
            )
        self.heard: list[tuple[int, Any]] = []
        self.bad = 0
        self.peer: Any = None
        self.stop = threading.Event()
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def seconds(self, stamp_ns: int) -> float:
        return 1e-9 * (stamp_ns - self.start_ns)

    def tell(self, message: Any) -> None:
        if self.peer is not None:
            data = message.pack(self.mav)
            self.mav.seq = (self.mav.seq + 1) % 256
            self.socket.sendto(data, self.peer)

    def run(self) -> None:
        next_ns = 0
        while not self.stop.is_set():
            now_ns = time.monotonic_ns()
            if now_ns >= next_ns:
                next_ns = now_ns + 20_000_000
                boot_ms = (now_ns + AHEAD_NS) // 1_000_000
                at_s = self.seconds(boot_ms * 1_000_000 - AHEAD_NS)
                self.tell(common.MAVLink_attitude_message(boot_ms, *attitude(at_s), 0.0, 0.0, 0.0))
                self.tell(common.MAVLink_local_position_ned_message(boot_ms, *position(at_s), 0.0, 0.0, 0.0))
            try:
                data, peer = self.socket.recvfrom(2048)
            except TimeoutError:
                continue
            for frame in messages_in(data)[0]:
                self.hear(frame, peer)

    def hear(self, frame: bytes, peer: Any) -> None:
        try:
            message = self.mav.decode(bytearray(frame))
        except common.MAVError:
            self.bad += 1
            return
        self.peer = peer
        self.heard.append((time.monotonic_ns(), message))
        if message.get_type() == "TIMESYNC" and message.tc1 == 0:
            self.tell(common.MAVLink_timesync_message(time.monotonic_ns() + AHEAD_NS, message.ts1))

    def of(self, kind: str) -> list[tuple[int, Any]]:
        return [(at_ns, message) for at_ns, message in list(self.heard) if message.get_type() == kind]

    def close(self) -> None:
        self.stop.set()
        self.thread.join()
        self.socket.close()


@contextmanager
def flying(
    target: Target, autopilot: Autopilot, *, key: bytes | None = None, system: int = 1
) -> Iterator[tuple[Autopilot9, MavlinkSink, Link]]:
    pilot = Autopilot9(key=key, system=system)
    link = Link(open_transport(f"udpout:127.0.0.1:{pilot.port}"), systems=[1], key=key)
    sink = MavlinkSink(link, target, MOUNT, MavlinkOptions(autopilot=autopilot, rate_hz=20.0))
    try:
        yield pilot, sink, link
    finally:
        sink.close()
        pilot.close()


def see(pilot: Autopilot9, sink: MavlinkSink, seconds: float) -> float:
    """What an estimator would say: images every 30 ms, their estimates 20 ms later, exact.

    Returns how far the clocks were apart at most once they had been compared [s].
    """
    worst_s = 0.0
    end_s = time.monotonic() + seconds
    while time.monotonic() < end_s:
        taken_ns = time.monotonic_ns()
        at_s = pilot.seconds(taken_ns)
        T_ned_body = np.eye(4)
        T_ned_body[:3] = np.column_stack([rotation_from_euler(*attitude(at_s)), position(at_s)])
        T = inverse(T_ned_body @ T_BODY_CAMERA) @ T_NED_TARGET
        time.sleep(0.02)
        sink.write(Outcome(estimate=estimate(T, stamp_ns=taken_ns), view=no_view()))
        time.sleep(PERIOD_S - 0.02)
        offset_ns = sink._link.clock.offset_ns
        worst_s = worst_s if offset_ns is None else max(worst_s, 1e-9 * abs(offset_ns - AHEAD_NS))
    return worst_s


def relative_by_px4(pilot: Autopilot9, message: Any) -> np.ndarray | None:
    """PX4 takes LANDING_TARGET in MAV_FRAME_LOCAL_NED with a valid position alone: relative = absolute - own place."""
    if message.frame != 1 or message.position_valid != 1:
        return None
    at_s = pilot.seconds(message.time_usec * 1000)
    return np.array([message.x, message.y, message.z]) - position(at_s)


def relative_by_ardupilot(pilot: Autopilot9, message: Any) -> np.ndarray | None:
    """ArduPilot takes MAV_FRAME_BODY_FRD alone: direction = xyz / distance, turned by its own attitude."""
    if message.frame != 12 or message.position_valid != 1 or message.distance <= 0.0:
        return None
    direction = np.array([message.x, message.y, message.z]) / message.distance
    assert abs(np.linalg.norm(direction) - 1.0) < 1e-5
    at_s = pilot.seconds(message.time_usec * 1000)
    return rotation_from_euler(*attitude(at_s)) @ direction * message.distance
