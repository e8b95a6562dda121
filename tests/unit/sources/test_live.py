# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Live sources: the newest image wins, what was dropped is counted, and what breaks off is told."""

import socket
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import av
import numpy as np
import pytest

from fairlead.io.errors import InputError
from fairlead.sources.live import QUEUE_LENGTH, LiveImages
from fairlead.sources.opening import open_images
from fairlead.sources.source import ImageFrame
from tests.clip import CAMERA

IMAGE = np.zeros((4, 4, 3), np.uint8)


def image(frame: int) -> ImageFrame:
    return ImageFrame(frame=frame, stamp_ns=frame, path=Path("live"), image=IMAGE)


def test_a_slow_consumer_gets_the_newest_and_the_rest_is_counted() -> None:
    grabbed = threading.Event()

    def grab() -> Iterator[ImageFrame]:
        for frame in range(100):
            yield image(frame)
        grabbed.set()

    source = LiveImages("live", grab)
    frames = []
    for each in source:
        assert grabbed.wait(5.0)
        frames.append(each.frame)
    source.close()
    assert frames[-QUEUE_LENGTH:] == [98, 99]
    assert len(frames) <= QUEUE_LENGTH + 1
    assert source.dropped == 100 - len(frames)


def test_a_quick_consumer_gets_every_image() -> None:
    taken = threading.Semaphore(1)

    def grab() -> Iterator[ImageFrame]:
        for frame in range(20):
            assert taken.acquire(timeout=5.0)
            yield image(frame)

    source = LiveImages("live", grab)
    frames = []
    for each in source:
        frames.append(each.frame)
        taken.release()
    assert frames == list(range(20))
    assert source.dropped == 0


def test_an_error_comes_after_the_images_before_it() -> None:
    def grab() -> Iterator[ImageFrame]:
        yield image(0)
        raise InputError("live", "gives no more images")

    source = iter(LiveImages("live", grab))
    assert next(source).frame == 0
    with pytest.raises(InputError, match="gives no more images"):
        next(source)


def test_silence_is_an_end_and_closing_is_quick() -> None:
    stop = threading.Event()

    def grab() -> Iterator[ImageFrame]:
        yield image(0)
        stop.wait(20.0)

    live = LiveImages("live", grab, silence_limit_s=0.3)
    source = iter(live)
    next(source)
    with pytest.raises(InputError, match=r"live: no image for 0\.3 s"):
        next(source)
    stop.set()
    start_s = time.monotonic()
    live.close()
    assert time.monotonic() - start_s < 1.0


def test_cameras_that_are_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="expected camera: and a number"):
        open_images("camera:front", CAMERA, fps=None, topic=None)
    with pytest.raises(InputError, match="no such camera"):
        list(open_images("camera:987", CAMERA, fps=None, topic=None))
    with pytest.raises(InputError, match="expected an address with one of rtsp"):
        open_images("gopher://host/a", CAMERA, fps=None, topic=None)
    with pytest.raises(InputError, match=r"rtsp://\*\*\*@127\.0\.0\.1:1/a: no readable video"):
        list(open_images("rtsp://me:secret@127.0.0.1:1/a", CAMERA, fps=None, topic=None))


def test_a_stream_from_the_network_keeps_its_stamps_on_this_machines_clock() -> None:
    """MPEG-TS over UDP on the loopback: images 50 ms apart, taken before they are here."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    stop = threading.Event()

    def send() -> None:
        container = av.open(f"udp://127.0.0.1:{port}?pkt_size=1316", "w", format="mpegts")
        stream = container.add_stream("mpeg2video", rate=20)
        stream.width, stream.height, stream.pix_fmt, stream.gop_size = 320, 240, "yuv420p", 2
        rng = np.random.default_rng(0)
        for i in range(200):
            picture = np.repeat(rng.integers(0, 256, (240, 320, 1), dtype=np.uint8), 3, axis=2)
            picture[:40, :40] = 20 + i
            frame = av.VideoFrame.from_ndarray(picture, format="bgr24")
            frame.pts = i
            for packet in stream.encode(frame):
                container.mux(packet)
            if stop.wait(0.05):
                break
        container.close()

    sender = threading.Thread(target=send, daemon=True)
    sender.start()
    source = open_images(f"udp://127.0.0.1:{port}", CAMERA, fps=None, topic=None)
    assert isinstance(source, LiveImages)
    frames: list[ImageFrame] = []
    arrived_ns: list[int] = []
    try:
        for each in source:
            frames.append(each)
            arrived_ns.append(time.monotonic_ns())
            if len(frames) == 15:
                break
    finally:
        stop.set()
        sender.join(5.0)
        source.close()
    stamps = np.array([each.stamp_ns for each in frames])
    numbers = np.array([each.frame for each in frames])
    assert frames[0].image.shape == (240, 320, 3)
    assert (np.diff(stamps) > 0).all()
    assert (stamps <= np.array(arrived_ns)).all()
    late = np.array(arrived_ns) - stamps
    assert late.min() < 50_000_000
    # Once the quickest image is there the stream's own clock holds: 50 ms an image to its tick of 11 us.
    assert abs((stamps[-1] - stamps[-5]) / (numbers[-1] - numbers[-5]) - 50_000_000) < 5_000_000
