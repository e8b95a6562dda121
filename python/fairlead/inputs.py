# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Where the views of a run come from: source and detector, and the camera that they belong to."""

import itertools
import logging
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fairlead.config import InputConfig, UsageError
from fairlead.io.camera import load_camera
from fairlead.io.errors import InputError
from fairlead.sources.live import LiveImages
from fairlead.sources.opening import KINDS, is_bag, open_images
from fairlead.sources.source import Image, ImageFrame, ImageSource, ViewSource
from fairlead.sources.table import SUFFIXES as TABLE_SUFFIXES
from fairlead.sources.table import TableSource
from fairlead.tracker import TrackerOptions
from fairlead.types import Camera, Correlation, Estimate, Target, View

if TYPE_CHECKING:
    from fairlead.detect import Detector

_log = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True, eq=False)
class Seen:
    """What is known of a frame before the estimator gets it."""

    view: View
    image: Image | None
    read_ms: float
    detect_ms: float


class DetectedViews:
    """The views that a detector finds in a sequence of images; each is looked at when it is asked for.

    An image that is the one before it, bit by bit, is a camera that froze: nothing is seen in it.
    """

    def __init__(self, images: ImageSource, detector: "Detector") -> None:
        self._images = images
        self._detector = detector
        self._frozen = FrozenCamera()

    def __iter__(self) -> Iterator[View]:
        return (seen.view for seen in self.seen())

    def seen(self) -> Iterator[Seen]:
        """Views with their images, and how long both took."""
        start_s = time.perf_counter()
        for image in self._images:
            read_s = time.perf_counter()
            view = nothing_seen(image) if self._frozen.is_repeated(image) else self._detect(image)
            done_s = time.perf_counter()
            yield Seen(
                view=view, image=image.image, read_ms=1e3 * (read_s - start_s), detect_ms=1e3 * (done_s - read_s)
            )
            start_s = time.perf_counter()

    @property
    def correlation(self) -> Correlation:
        """How long the detector's errors stay."""
        return self._detector.correlation

    def follow(self, estimate: Estimate) -> None:
        """Tell the detector where the estimator sees the target, before the next image is looked at."""
        self._detector.follow(estimate)

    def _detect(self, image: ImageFrame) -> View:
        return self._detector.detect(image.image, image.frame, image.stamp_ns)

    def count(self) -> int:
        """Number of images; 0 where nobody knows."""
        return self._images.count()

    def work(self, view: View) -> int:
        """One image."""
        del view
        return 1

    @property
    def dropped(self) -> int:
        """Images of a live source that nobody had time for."""
        return self._images.dropped if isinstance(self._images, LiveImages) else 0

    def close(self) -> None:
        """Let go of a camera or a stream."""
        if isinstance(self._images, LiveImages):
            self._images.close()


class FrozenCamera:
    """Tells images that repeat the one before: no sensor gives the same noise twice."""

    def __init__(self) -> None:
        self._last: Image | None = None
        self._warned = False

    def is_repeated(self, image: ImageFrame) -> bool:
        """Whether this is the image before it; the first time there is a warning."""
        last, self._last = self._last, image.image
        if last is None or last.shape != image.image.shape or not (last[::37] == image.image[::37]).all():
            return False
        if not (last == image.image).all():
            return False
        if not self._warned:
            self._warned = True
            _log.warning("%s: frame %d repeats the one before it: the camera froze", image.path, image.frame)
        return True


def nothing_seen(image: ImageFrame) -> View:
    """A view without observations."""
    return View(
        frame=image.frame,
        stamp_ns=image.stamp_ns,
        landmarks=(),
        pixels=np.empty((0, 2)),
        covariances=np.empty((0, 2, 2)),
    )


def open_views(config: InputConfig, target: Target, camera: Camera) -> ViewSource:
    """A table, or images with a detector, by what the source is. Raises InputError, UsageError."""
    source = config.source
    if isinstance(source, Path) and source.suffix in TABLE_SUFFIXES and not source.is_dir():
        if config.detector is not None:
            raise UsageError(f"--detector: {source} holds observations already")
        return TableSource(source, target.landmarks)
    if config.detector is None:
        if isinstance(source, Path) and not source.exists():
            raise InputError(source, f"is not there; expected {KINDS}")
        raise UsageError(f"{source} holds images: expected --detector too")
    from fairlead.detect import detector_from_spec

    try:
        detector = detector_from_spec(config.detector, target, camera)
    except InputError:
        raise
    except ValueError as error:
        raise UsageError(f"--detector: {str(error).removeprefix('detector: ')}") from error
    images = open_images(source, camera, fps=config.fps, topic=config.topic)
    return DetectedViews(images, detector)


def told_correlation(source: ViewSource, options: TrackerOptions) -> TrackerOptions:
    """The options, with what the detector says of its errors where they say nothing."""
    said = options.correlation_time_s, options.correlation_angle_rad, options.correlation_log_range
    if any(said) or options.design_effect > 1.0 or not isinstance(source, DetectedViews):
        return options
    told = source.correlation
    return replace(
        options,
        correlation_time_s=told.time_s,
        correlation_angle_rad=told.angle_rad,
        correlation_log_range=told.log_range,
        design_effect=told.design_effect,
    )


def follow(source: ViewSource, estimate: Estimate) -> None:
    """Hand the estimate to what looks at the next image, if anything does."""
    if isinstance(source, DetectedViews):
        source.follow(estimate)


def let_go(source: ViewSource) -> int:
    """Release cameras and streams; returns how many images were dropped."""
    if not isinstance(source, DetectedViews):
        return 0
    source.close()
    return source.dropped


def open_camera(config: InputConfig) -> Camera:
    """The calibration that was named, else that of the bag. Raises InputError, UsageError."""
    if config.camera is not None:
        return load_camera(config.camera, name=config.camera_name)
    if isinstance(config.source, Path) and is_bag(config.source):
        from fairlead.sources.bag import bag_camera

        return bag_camera(config.source, topic=config.topic)
    raise UsageError(f"{config.source} brings no calibration: expected --camera too")


def timed_views(source: ViewSource, path: Path | str) -> Iterator[Seen]:
    """Views and the time to get each. The first is fetched at once, so that a bad source is found out early."""
    iterator = source.seen() if isinstance(source, DetectedViews) else _stopwatch(source)
    first = next(iterator, None)
    if first is None:
        raise InputError(path, "holds no frames")
    return itertools.chain([first], iterator)


def _stopwatch(source: ViewSource) -> Iterator[Seen]:
    start_s = time.perf_counter()
    for view in source:
        yield Seen(view=view, image=None, read_ms=math.nan, detect_ms=1e3 * (time.perf_counter() - start_s))
        start_s = time.perf_counter()
