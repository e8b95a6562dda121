# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Estimates to an autopilot while they are fresh: paced, silent within 0.2 s of a loss, docs/mavlink.md section 4."""

import threading
import time
from collections import deque
from dataclasses import dataclass

import numpy as np

from fairlead.io.mount import Mount
from fairlead.sinks.autopilots import Autopilot
from fairlead.sinks.mavlink.link import Link
from fairlead.sinks.mavlink.report import landing_target, relative_target, sight
from fairlead.sinks.mavlink.vehicle import UNKNOWN
from fairlead.sinks.sink import Outcome
from fairlead.types import Estimate, Target

FRESH_NS = 200_000_000
"""Older news is no news; without fresh news the target is lost."""
QUEUE_LENGTH = 4
_TURN_S = 0.005
_BEAT_NS = 1_000_000_000
_ASK_NS = 200_000_000
_GOODBYE_S = 2.0


@dataclass(frozen=True, kw_only=True)
class MavlinkOptions:
    """How to speak."""

    autopilot: Autopilot
    rate_hz: float = 20.0
    """Estimates sent at most [1/s]; each is two messages. PX4 and ArduPilot want 1/s at least."""
    live: bool = True
    """Whether stamps are of this machine's monotonic clock; else an image was taken when its estimate came."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _News:
    estimate: Estimate
    taken_ns: int


class MavlinkSink:
    """A thread that sends the newest estimate, listens, and keeps time. `write` never waits."""

    def __init__(self, link: Link, target: Target, mount: Mount, options: MavlinkOptions) -> None:
        self._link, self._mount, self._options = link, mount, options
        self._X = np.zeros(3) if target.touchdown is None else np.asarray(target.touchdown)
        self._news: deque[_News] = deque(maxlen=QUEUE_LENGTH)
        self._last_tracked_ns: int | None = None
        self._closing = threading.Event()
        self._valid = False
        self._reason = "no image"
        self.sent, self.stale = 0, 0
        """Estimates that were sent, and those that were too old or not needed."""
        self._thread = threading.Thread(target=self._run, name="mavlink", daemon=True)
        self._thread.start()

    def write(self, outcome: Outcome) -> None:
        """Take an estimate; one that only coasts counts for 0.2 s."""
        estimate = outcome.estimate
        if estimate.status == "tracking":
            self._last_tracked_ns = estimate.stamp_ns
        recent = self._last_tracked_ns is not None and estimate.stamp_ns - self._last_tracked_ns <= FRESH_NS
        if not (estimate.ok and recent):
            self._reason = estimate.reason or estimate.status
            return
        taken_ns = estimate.stamp_ns if self._options.live else time.monotonic_ns()
        self.stale += len(self._news) == QUEUE_LENGTH
        self._news.append(_News(estimate=estimate, taken_ns=taken_ns))

    def _run(self) -> None:
        beat_ns = ask_ns = next_ns = fresh_ns = 0
        while not self._closing.is_set():
            if self._link.read(_TURN_S):
                self._closing.wait(_TURN_S)  # a flood: leave the processor to others
            now_ns = time.monotonic_ns()
            if now_ns >= ask_ns:
                self._link.ask_time()
                ask_ns = now_ns + _ASK_NS
            if now_ns >= next_ns and self._news:
                sent_ns = self._send_newest(now_ns)
                fresh_ns = fresh_ns if sent_ns is None else sent_ns
                next_ns = now_ns + round(1e9 / self._options.rate_hz)
            valid = now_ns - fresh_ns <= FRESH_NS and fresh_ns > 0
            if valid != self._valid or now_ns >= beat_ns:
                self._tell(valid=valid)
                beat_ns = now_ns + _BEAT_NS

    def _send_newest(self, now_ns: int) -> int | None:
        """When the image of what was sent was taken; None where nothing was."""
        news = self._news.pop()
        self.stale += len(self._news)
        self._news.clear()
        if now_ns - news.taken_ns > FRESH_NS:
            self.stale += 1
            return None
        offset_ns = self._link.clock.offset_ns
        state = UNKNOWN if offset_ns is None else self._link.vehicle.at(news.taken_ns + offset_ns)
        sighting = sight(news.estimate, self._X, self._mount, state, news.taken_ns // 1000)
        message = None if sighting is None else landing_target(sighting, self._options.autopilot)
        if sighting is None:
            self._reason = "no gimbal attitude"
            return None
        self._link.send(relative_target(sighting))
        if message is None:
            self._reason = "no attitude or position of the vehicle"
            return None
        self._link.send(message)
        self.sent += 1
        return news.taken_ns

    def _tell(self, *, valid: bool) -> None:
        """Heartbeat; a line for the pilot when the target comes or goes."""
        if valid != self._valid:
            self._valid = valid
            text = "fairlead: target in sight" if valid else f"fairlead: target lost ({self._reason})"
            self._link.say(text, warning=not valid)
        self._link.heartbeat(active=valid)

    def close(self) -> None:
        """Say goodbye; safe to call twice."""
        if self._closing.is_set():
            return
        self._closing.set()
        self._thread.join(_GOODBYE_S)
        self._reason = "end of the run"
        self._tell(valid=False)
        self._link.close()
