# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What is said to the autopilot and what of its messages is believed."""

import logging
import time
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any

import numpy as np

from fairlead.geometry import exp_so3, matrix_from_quat_xyzw
from fairlead.io.documents import describe_os_error
from fairlead.io.errors import InputError
from fairlead.io.mount import rotation_from_euler
from fairlead.sinks.mavlink.clocks import TimeSync
from fairlead.sinks.mavlink.dialect import COMPONENT, mavlink, messages_in
from fairlead.sinks.mavlink.transport import Transport
from fairlead.sinks.mavlink.vehicle import Vehicle

_log = logging.getLogger(__name__)

MAX_READS = 20
"""Datagrams looked at in one turn; of a flood the operating system drops the rest."""
_AUTOPILOT = 1
"""MAV_COMP_ID_AUTOPILOT1."""
_EPOCH_2015_S = 1_420_070_400
_YAW_LOCK, _YAW_IN_VEHICLE, _YAW_IN_EARTH = 16, 32, 64
"""GIMBAL_DEVICE_FLAGS."""
_MAX_PENDING_BYTES = 4096


class Link:
    """Packs, signs, parses. Bad data are counted and never raise.

    Parameters
    ----------
    systems : ids of the systems that are listened to; this machine speaks as the first one's onboard computer
    key : 32 bytes; then everything is signed, and what is not is refused
    """

    def __init__(self, transport: Transport, *, systems: Collection[int], key: bytes | None = None) -> None:
        self.vehicle, self.clock = Vehicle(), TimeSync()
        self.received, self.refused = 0, 0
        self._transport, self._systems = transport, tuple(systems)
        self._pending = b""
        self._mav: Any = mavlink().MAVLink(None, srcSystem=self._systems[0], srcComponent=COMPONENT)
        if key is not None:
            signing = self._mav.signing
            signing.secret_key, signing.sign_outgoing, signing.link_id = key, True, 0
            signing.timestamp = int((time.time() - _EPOCH_2015_S) * 1e5)
        self._handlers: dict[str, Callable[[Any, int], None]] = {
            "ATTITUDE": self._attitude,
            "LOCAL_POSITION_NED": self._position,
            "GIMBAL_DEVICE_ATTITUDE_STATUS": self._gimbal,
            "TIMESYNC": self._timesync,
        }

    def send(self, message: Any) -> bool:
        """Whether it was handed on."""
        data = message.pack(self._mav)
        self._mav.seq = (self._mav.seq + 1) % 256
        return self._transport.send(data)

    def heartbeat(self, *, active: bool) -> None:
        """As an onboard computer; standby while there is nothing to report."""
        names = mavlink()
        state = names.MAV_STATE_ACTIVE if active else names.MAV_STATE_STANDBY
        self.send(
            names.MAVLink_heartbeat_message(
                names.MAV_TYPE_ONBOARD_CONTROLLER, names.MAV_AUTOPILOT_INVALID, 0, 0, state, 3
            )
        )

    def say(self, text: str, *, warning: bool) -> None:
        """A line for the pilot."""
        names = mavlink()
        severity = names.MAV_SEVERITY_WARNING if warning else names.MAV_SEVERITY_INFO
        self.send(names.MAVLink_statustext_message(severity, text.encode("ascii", "replace")[:50]))

    def ask_time(self) -> None:
        """TIMESYNC."""
        self.send(mavlink().MAVLink_timesync_message(0, self.clock.ask(time.monotonic_ns())))

    def read(self, wait_s: float) -> bool:
        """Take what has come, or comes in this time, up to MAX_READS pieces. Returns whether there may be more."""
        self._transport.wait(wait_s)
        for _ in range(MAX_READS):
            data = self._transport.receive()
            if data is None:
                return False
            now_ns = time.monotonic_ns()
            frames, rest = messages_in(self._pending + data)
            self._pending = rest[-_MAX_PENDING_BYTES:] if self._transport.stream else b""
            self.refused += not frames and not self._transport.stream
            for frame in frames:
                self._take(frame, now_ns)
        return True

    def _take(self, frame: bytes, now_ns: int) -> None:
        try:
            message = self._mav.decode(bytearray(frame))
        except Exception:  # whatever a stranger's bytes make pymavlink raise
            self.refused += 1
            return
        if message.get_srcSystem() not in self._systems or not self._may_say(message):
            self.refused += 1
            return
        self.received += 1
        self._transport.believe()
        handler = self._handlers.get(message.get_type())
        if handler is not None:
            handler(message, now_ns)

    def _may_say(self, message: Any) -> bool:
        """The state of the vehicle comes from its autopilot alone; finite numbers only."""
        if message.get_type() not in self._handlers:
            return True
        if message.get_type() != "GIMBAL_DEVICE_ATTITUDE_STATUS" and message.get_srcComponent() != _AUTOPILOT:
            return False
        return bool(np.isfinite(np.hstack(list(message.to_dict().values())[1:]).astype(np.float64)).all())

    def _stamp_ns(self, message: Any) -> int:
        return int(message.time_boot_ms) * 1_000_000

    def _attitude(self, message: Any, now_ns: int) -> None:
        del now_ns
        R = rotation_from_euler(message.roll, message.pitch, message.yaw)
        self.vehicle.attitude.add(self._stamp_ns(message), R)

    def _position(self, message: Any, now_ns: int) -> None:
        del now_ns
        self.vehicle.position.add(self._stamp_ns(message), np.array([message.x, message.y, message.z]))

    def _gimbal(self, message: Any, now_ns: int) -> None:
        """Its yaw counts from north or from the vehicle's heading, as its flags say, docs/mavlink.md section 3."""
        del now_ns
        w, x, y, z = message.q
        if w * w + x * x + y * y + z * z < 0.5:
            return
        R_ned_gimbal = matrix_from_quat_xyzw(np.array([x, y, z, w]))
        stamp_ns = self._stamp_ns(message)
        from_north = bool(message.flags & (_YAW_IN_EARTH | _YAW_LOCK)) and not message.flags & _YAW_IN_VEHICLE
        turn = np.eye(3)
        if not from_north:
            R_ned_body = self.vehicle.attitude.at(stamp_ns)
            if R_ned_body is None:
                return
            heading = float(np.arctan2(R_ned_body[1, 0], R_ned_body[0, 0]))
            turn = exp_so3(np.array([0.0, 0.0, heading]))
        self.vehicle.gimbal.add(stamp_ns, turn @ R_ned_gimbal)

    def _timesync(self, message: Any, now_ns: int) -> None:
        if message.tc1 == 0:
            self.send(mavlink().MAVLink_timesync_message(now_ns, message.ts1))
        else:
            self.clock.answer(message.tc1, message.ts1, now_ns)

    def close(self) -> None:
        """Let go of the port."""
        self._transport.close()


def load_key(path: Path) -> bytes:
    """The secret of MAVLink's signing: 32 bytes, or 64 hexadecimal digits. Raises InputError."""
    try:
        data = path.read_bytes()[:1024]
    except OSError as error:
        raise InputError(path, f"cannot be read: {describe_os_error(error)}") from error
    if len(data) == 32:
        return data
    try:
        key = bytes.fromhex(data.decode("ascii"))
    except (UnicodeDecodeError, ValueError):
        key = b""
    if len(key) != 32:
        raise InputError(path, "expected 32 bytes or 64 hexadecimal digits")
    return key
