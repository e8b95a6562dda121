# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Bytes to and from an autopilot: UDP, or what pymavlink can open. Nothing here ever raises for what a peer does."""

import select
import socket
import time
from typing import Any, Protocol, runtime_checkable

from fairlead.io.errors import InputError

RECEIVE_BYTES = 65_536
"""Room for what was not read yet; a flood fills it, and the rest is dropped by the operating system."""
_DATAGRAM_BYTES = 2_048


@runtime_checkable
class Transport(Protocol):
    """Datagrams, or pieces of a stream."""

    stream: bool
    """Whether a message may come in pieces."""

    def send(self, data: bytes) -> bool:
        """Whether it was handed on."""
        ...

    def receive(self) -> bytes | None:
        """What came; None where nothing did. Does not wait."""
        ...

    def wait(self, seconds: float) -> None:
        """Until something comes, or so long."""
        ...

    def believe(self) -> None:
        """What came last was a valid message of a system that may speak."""
        ...

    def close(self) -> None:
        """Let go."""
        ...


class UdpTransport:
    """`udpout` speaks to one address and hears that one alone; `udpin` answers whoever spoke last."""

    stream = False

    def __init__(self, host: str, port: int, *, listen: bool) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._peer: Any = None
        self._from: Any = None
        try:
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BYTES)
            self._socket.settimeout(0.0)
            if listen:
                self._socket.bind((host, port))
            else:
                self._socket.connect((host, port))
        except (OSError, OverflowError) as error:
            self._socket.close()
            raise InputError("--mavlink", f"{host}:{port}: {error}") from error
        self._listen = listen

    def send(self, data: bytes) -> bool:
        """Whether it was handed on; a closed port, or nobody yet to answer to, is not an error."""
        try:
            if not self._listen:
                return self._socket.send(data) == len(data)
            return self._peer is not None and self._socket.sendto(data, self._peer) == len(data)
        except OSError:
            return False

    def receive(self) -> bytes | None:
        """One datagram."""
        try:
            data, self._from = self._socket.recvfrom(_DATAGRAM_BYTES)
        except OSError:
            return None
        return data

    def wait(self, seconds: float) -> None:
        """Until a datagram comes, or so long."""
        select.select([self._socket], [], [], seconds)

    def believe(self) -> None:
        """The last datagram was a valid message of a system that may speak: answer there."""
        self._peer = self._from

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


class PymavlinkTransport:
    """A serial port or TCP, as pymavlink opens it."""

    stream = True

    def __init__(self, address: str) -> None:
        try:
            from pymavlink import mavutil

            device, _, baud = address.partition(":") if address.startswith("/dev/") else (address, "", "")
            self._link: Any = mavutil.mavlink_connection(device, baud=int(baud or 115200), retries=1)
        except Exception as error:  # pyserial and sockets raise what they like
            raise InputError("--mavlink", f"{address}: {error}") from error

    def send(self, data: bytes) -> bool:
        """Whether it was handed on."""
        try:
            self._link.write(data)
        except Exception:  # a port that was pulled out
            return False
        return True

    def receive(self) -> bytes | None:
        """What came."""
        try:
            data = self._link.recv(_DATAGRAM_BYTES)
        except Exception:  # as above
            return None
        return bytes(data) or None

    def wait(self, seconds: float) -> None:
        """So long: not every port can be waited for."""
        time.sleep(seconds)

    def believe(self) -> None:
        """There is one peer only."""

    def close(self) -> None:
        """Close the port."""
        self._link.close()


def open_transport(address: str) -> Transport:
    """udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT, /dev/ttyACM0[:BAUD]. Raises InputError."""
    kind, _, rest = address.partition(":")
    if kind in ("udpout", "udpin"):
        host, _, port = rest.rpartition(":")
        if not host or not (port.isascii() and port.isdigit()):
            raise InputError("--mavlink", f"expected {kind}:HOST:PORT, got {address!r}")
        return UdpTransport(host, int(port), listen=kind == "udpin")
    if kind == "tcp" or address.startswith("/dev/"):
        return PymavlinkTransport(address)
    known = "udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT or /dev/..."
    raise InputError("--mavlink", f"expected {known}, got {address!r}")
