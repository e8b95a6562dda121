# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Live sources: the newest image wins, and what nobody had time for is counted, docs/pipeline.md section 2."""

import threading
from collections import deque
from collections.abc import Callable, Iterator

from fairlead.io.errors import InputError
from fairlead.sources.source import ImageFrame

QUEUE_LENGTH = 2
"""Images that wait at most; older ones are dropped."""
SILENCE_LIMIT_S = 5.0
"""Without an image for so long a live source has ended."""
FIRST_LIMIT_S = 15.0
"""Until the first one: cameras and streams take their time to open."""
_POLL_S = 0.2
_GOODBYE_S = 2.0

Grabber = Iterator[ImageFrame]


class LiveImages:
    """Images that come when they come. A thread grabs them; whoever iterates gets the newest.

    `frame` counts the images that were grabbed, so a gap in it tells of dropped ones. Raises whatever the grabber
    raises, after the images before; InputError when nothing has come for SILENCE_LIMIT_S.
    """

    def __init__(self, name: str, grab: Callable[[], Grabber], *, silence_limit_s: float = SILENCE_LIMIT_S) -> None:
        self._name = name
        self._grab = grab
        self._limit_s = silence_limit_s
        self._dropped = 0
        self._queue: deque[ImageFrame] = deque()
        self._ready = threading.Condition()
        self._closing = threading.Event()
        self._thread: threading.Thread | None = None
        self._started = False
        self._ended = False
        self._error: Exception | None = None

    @property
    def dropped(self) -> int:
        """Images that were grabbed and not handed out."""
        return self._dropped

    def count(self) -> int:
        """Nobody knows: 0."""
        return 0

    def __iter__(self) -> Iterator[ImageFrame]:
        self._thread = threading.Thread(target=self._run, name=f"grab {self._name}", daemon=True)
        self._thread.start()
        while (image := self._next()) is not None:
            yield image

    def close(self) -> None:
        """End the thread, or leave it where it hangs after two seconds."""
        self._closing.set()
        if self._thread is not None:
            self._thread.join(_GOODBYE_S)

    def _next(self) -> ImageFrame | None:
        waited_s = 0.0
        limit_s = self._limit_s if self._started else max(self._limit_s, FIRST_LIMIT_S)
        with self._ready:
            while not self._queue:
                if self._error is not None:
                    raise self._error
                if self._ended:
                    return None
                if waited_s >= limit_s:
                    raise InputError(self._name, f"no image for {limit_s:g} s")
                if not self._ready.wait(_POLL_S):
                    waited_s += _POLL_S
            self._started = True
            return self._queue.popleft()

    def _run(self) -> None:
        try:
            for image in self._grab():
                if self._closing.is_set():
                    return
                self._put(image)
        except Exception as error:  # raised again where the images are taken
            self._error = error
        finally:
            with self._ready:
                self._ended = True
                self._ready.notify_all()

    def _put(self, image: ImageFrame) -> None:
        with self._ready:
            if len(self._queue) >= QUEUE_LENGTH:
                self._queue.popleft()
                self._dropped += 1
            self._queue.append(image)
            self._ready.notify_all()


def check_size(name: str, got: tuple[int, int], expected: tuple[int, int]) -> None:
    """Raises InputError unless the images have the size of the camera (width, height)."""
    if got != expected:
        wanted = f"expected {expected[0]} x {expected[1]} as the camera has"
        raise InputError(name, f"{wanted}, got images of {got[0]} x {got[1]}")
