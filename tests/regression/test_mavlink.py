# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""An autopilot on the loopback that follows PX4's and ArduPilot's rules, and people who mean harm."""

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest
from pymavlink.dialects.v20 import common

from fairlead.geometry import exp_se3, inverse
from fairlead.io.mount import Mount, rotation_from_euler
from fairlead.io.target import load_target
from fairlead.sinks.mavlink import MavlinkOptions, MavlinkSink
from fairlead.sinks.mavlink.dialect import messages_in, target_relative
from fairlead.sinks.mavlink.link import Link
from fairlead.sinks.mavlink.transport import UdpTransport, open_transport
from fairlead.sinks.sink import Outcome
from fairlead.types import Autopilot, Target
from tests.clip import Clip
from tests.outcomes import estimate, lost, no_view

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


@pytest.fixture(autouse=True)
def _dialect_of_the_receiver(monkeypatch: pytest.MonkeyPatch) -> None:
    """An autopilot of today knows TARGET_RELATIVE; pymavlink's dialect does not yet."""
    monkeypatch.setitem(common.mavlink_map, 511, target_relative())


@pytest.fixture
def target(clip: Clip) -> Target:
    return load_target(clip.folder / "target.toml")


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


@pytest.mark.parametrize(("autopilot", "rule"), [("px4", relative_by_px4), ("ardupilot", relative_by_ardupilot)])
def test_an_autopilot_recovers_the_true_relative_position(target: Target, autopilot: Any, rule: Any) -> None:
    with flying(target, autopilot) as (pilot, sink, _):
        apart_s = see(pilot, sink, 1.5)
        heard = pilot.of("LANDING_TARGET")
        relative = pilot.of("TARGET_RELATIVE")
    assert len(heard) >= 15
    # The line of sight of 30 m turns at 0.7 rad/s and the vehicle moves at 3 m/s: 25 m/s by which the clocks are apart.
    # States are 20 ms apart and bend by 1 rad/s^2: 1 cm.
    assert apart_s < 0.02
    tolerance_m = 0.02 + 25.0 * apart_s
    assert np.diff([at_ns for at_ns, _ in heard]).max() < 1e9, "ArduPilot wants one a second"
    for _, message in heard:
        at_s = pilot.seconds(message.time_usec * 1000)
        true = T_NED_TARGET[:3, 3] - position(at_s)
        found = rule(pilot, message)
        assert found is not None
        assert np.linalg.norm(found - true) < tolerance_m
    with_attitude = [message for _, message in relative if message.frame == 2]
    assert len(with_attitude) >= 15
    for message in with_attitude:
        at_s = pilot.seconds(message.timestamp * 1000)
        found = np.array([message.x, message.y, message.z])
        assert np.linalg.norm(found - (T_NED_TARGET[:3, 3] - position(at_s))) < tolerance_m


def test_a_lost_target_is_silent_and_said_within_a_fifth_of_a_second(target: Target) -> None:
    with flying(target, "ardupilot") as (pilot, sink, _):
        see(pilot, sink, 0.5)
        lost_ns = time.monotonic_ns()
        for _ in range(15):
            sink.write(Outcome(estimate=lost(), view=no_view()))
            time.sleep(0.03)
        last_ns = max(at_ns for at_ns, _ in pilot.of("LANDING_TARGET"))
        beats = [(at_ns, m.system_status) for at_ns, m in pilot.of("HEARTBEAT") if at_ns > lost_ns]
        texts = [(at_ns, m.text) for at_ns, m in pilot.of("STATUSTEXT")]
    assert last_ns - lost_ns < 200_000_000
    assert beats[0][1] == common.MAV_STATE_STANDBY
    assert beats[0][0] - lost_ns < 300_000_000  # 0.2 s, and what a busy machine adds
    assert [text for _, text in texts] == ["fairlead: target in sight", "fairlead: target lost (too_few)"]


def test_coasting_and_old_news_do_not_count(target: Target) -> None:
    with flying(target, "ardupilot") as (pilot, sink, _):
        see(pilot, sink, 0.3)
        time.sleep(0.1)
        before = len(pilot.of("LANDING_TARGET"))
        now_ns = time.monotonic_ns()
        T = exp_se3(np.array([0.0, 0.0, 9.0, 0.0, 0.0, 0.0]))
        sink.write(Outcome(estimate=estimate(T, stamp_ns=now_ns + 10**9, status="coasting"), view=no_view()))
        sink.write(Outcome(estimate=estimate(T, stamp_ns=now_ns - 300_000_000), view=no_view()))
        time.sleep(0.2)
        assert len(pilot.of("LANDING_TARGET")) == before


def test_the_output_is_paced_and_the_newest_wins(target: Target) -> None:
    with flying(target, "ardupilot") as (pilot, sink, _):
        start_s = time.monotonic()
        while (elapsed_s := time.monotonic() - start_s) < 0.6:
            for _ in range(20):
                T = exp_se3(np.array([0.0, 0.0, 9.0, 0.0, 0.0, 0.0]))
                sink.write(Outcome(estimate=estimate(T, stamp_ns=time.monotonic_ns()), view=no_view()))
            time.sleep(0.001)
        heard = pilot.of("LANDING_TARGET")
        assert 3 <= len(heard) <= 20.0 * elapsed_s + 2
        assert sink.stale > 100
        late_ns = [at_ns - 1000 * message.time_usec for at_ns, message in heard]
    assert max(late_ns) < 100_000_000


def test_signed_messages_pass_and_unsigned_spoofs_do_not(target: Target) -> None:
    with flying(target, "px4", key=KEY) as (pilot, sink, link):
        spoof = common.MAVLink(None, srcSystem=1, srcComponent=1)
        see(pilot, sink, 0.2)
        for i in range(50):
            boot_ms = (time.monotonic_ns() + AHEAD_NS) // 1_000_000
            data = common.MAVLink_local_position_ned_message(boot_ms + i, 9e3, 9e3, 0, 0, 0, 0).pack(spoof)
            pilot.socket.sendto(data, pilot.peer)
        apart_s = see(pilot, sink, 0.8)
        heard = pilot.of("LANDING_TARGET")
        assert link.refused >= 20
        assert pilot.bad == 0
        assert all(message._signed for _, message in heard)
        assert len(heard) >= 5
        for _, message in heard:
            found = relative_by_px4(pilot, message)
            assert found is not None
            true = T_NED_TARGET[:3, 3] - position(pilot.seconds(message.time_usec * 1000))
            assert np.linalg.norm(found - true) < 0.02 + 25.0 * apart_s


def test_other_systems_are_not_believed(target: Target) -> None:
    with flying(target, "px4", system=7) as (pilot, sink, link):
        see(pilot, sink, 0.4)
        assert pilot.of("LANDING_TARGET") == [], "no state of vehicle 1 was ever heard"
        assert link.received == 0
        assert link.refused > 5


def test_a_flood_of_rubbish_changes_nothing(target: Target) -> None:
    """Strangers on the same machine: 100 kB of noise and frames with every bit wrong, as quick as they can."""
    with flying(target, "px4") as (pilot, sink, link):
        see(pilot, sink, 0.4)
        stop = threading.Event()

        def flood() -> None:
            rng = np.random.default_rng(0)
            rubbish = [rng.integers(0, 256, 80, dtype=np.uint8).tobytes() for _ in range(50)]
            rubbish += [b"\xfd" + each for each in rubbish]
            while not stop.is_set():
                for each in rubbish:
                    pilot.socket.sendto(each, pilot.peer)
                time.sleep(0.002)

        thread = threading.Thread(target=flood, daemon=True)
        thread.start()
        before = len(pilot.of("LANDING_TARGET"))
        start_s = time.monotonic()
        apart_s = see(pilot, sink, 0.8)
        assert time.monotonic() - start_s < 3.0, "write must not wait"
        heard = pilot.of("LANDING_TARGET")[before:]
        stop.set()
        thread.join()
        assert link.refused > 100
        for _, message in heard:
            found = relative_by_px4(pilot, message)
            assert found is not None
            true = T_NED_TARGET[:3, 3] - position(pilot.seconds(message.time_usec * 1000))
            # States that came through are up to 150 ms apart and lead on for 60: 30 m x 1 rad/s^2 x 0.06 x 0.21 / 2.
            assert np.linalg.norm(found - true) < 0.2 + 25.0 * apart_s


def test_a_closed_port_does_no_harm(target: Target) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    link = Link(open_transport(f"udpout:127.0.0.1:{port}"), systems=[1])
    sink = MavlinkSink(link, target, MOUNT, MavlinkOptions(autopilot="ardupilot"))
    T = exp_se3(np.array([0.0, 0.0, 9.0, 0.0, 0.0, 0.0]))
    for _ in range(10):
        sink.write(Outcome(estimate=estimate(T, stamp_ns=time.monotonic_ns()), view=no_view()))
        time.sleep(0.02)
    assert sink.sent >= 1
    sink.close()
    sink.close()


def test_udpin_answers_only_who_was_believed() -> None:
    link_port = UdpTransport("127.0.0.1", 0, listen=True)
    port = link_port._socket.getsockname()[1]
    link = Link(link_port, systems=[1])
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as good,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as bad,
    ):
        for each in (good, bad):
            each.bind(("127.0.0.1", 0))
            each.settimeout(0.3)
        beat = common.MAVLink_heartbeat_message(2, 12, 0, 0, 4, 3)
        good.sendto(beat.pack(common.MAVLink(None, srcSystem=1, srcComponent=1)), ("127.0.0.1", port))
        bad.sendto(b"\xfd" * 40, ("127.0.0.1", port))
        bad.sendto(beat.pack(common.MAVLink(None, srcSystem=9, srcComponent=1)), ("127.0.0.1", port))
        time.sleep(0.05)
        link.read(0.05)
        link.heartbeat(active=True)
        assert good.recv(100)
        with pytest.raises(TimeoutError):
            bad.recv(100)
    link.close()
