# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The autopilot's clock and this machine's, docs/mavlink.md eq. (4)."""

from collections import deque

MAX_ROUND_TRIP_NS = 100_000_000
_OUTSTANDING = 16
_KEPT = 16


class TimeSync:
    """Offset of the autopilot's clock by TIMESYNC; of the last answers, the quickest is believed.

    An answer counts only if it echoes a question that was asked and not answered yet.
    """

    def __init__(self) -> None:
        self._asked: deque[int] = deque(maxlen=_OUTSTANDING)
        self._answers: deque[tuple[int, int]] = deque(maxlen=_KEPT)

    def ask(self, now_ns: int) -> int:
        """The stamp to send."""
        self._asked.append(now_ns)
        return now_ns

    def answer(self, theirs_ns: int, ours_ns: int, now_ns: int) -> bool:
        """Take an answer: their clock when they had our question of `ours_ns`. Returns whether it was believed."""
        if ours_ns not in self._asked:
            return False
        self._asked.remove(ours_ns)
        round_trip_ns = now_ns - ours_ns
        if not 0 <= round_trip_ns <= MAX_ROUND_TRIP_NS:
            return False
        self._answers.append((round_trip_ns, theirs_ns - ours_ns - round_trip_ns // 2))
        return True

    @property
    def offset_ns(self) -> int | None:
        """Their clock minus ours; None before the first answer."""
        return min(self._answers)[1] if self._answers else None
