# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""An autopilot on the loopback that follows PX4's and ArduPilot's rules, and people who mean harm."""

import socket
import threading
import time
from typing import Any

import numpy as np
import pytest
from pymavlink.dialects.v20 import common

from fairlead.geometry import exp_se3
from fairlead.io.target import load_target
from fairlead.sinks.mavlink import MavlinkOptions, MavlinkSink
from fairlead.sinks.mavlink.dialect import target_relative
from fairlead.sinks.mavlink.link import Link
from fairlead.sinks.mavlink.transport import UdpTransport, open_transport
from fairlead.sinks.sink import Outcome
from fairlead.types import Target
from tests.autopilot import (
    AHEAD_NS,
    KEY,
    MOUNT,
    T_NED_TARGET,
    flying,
    position,
    relative_by_ardupilot,
    relative_by_px4,
    see,
)
from tests.clip import Clip
from tests.outcomes import estimate, lost, no_view


@pytest.fixture(autouse=True)
def _dialect_of_the_receiver(monkeypatch: pytest.MonkeyPatch) -> None:
    """An autopilot of today knows TARGET_RELATIVE; pymavlink's dialect does not yet."""
    monkeypatch.setitem(common.mavlink_map, 511, target_relative())


@pytest.fixture
def target(clip: Clip) -> Target:
    return load_target(clip.folder / "target.toml")


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
        assert sink.stale > len(heard)
        late_ns = [at_ns - 1000 * message.time_usec for at_ns, message in heard]
    assert max(late_ns) < 300_000_000  # 0.2 s, and what a busy machine adds


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
