# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Finding the target in a whole image, docs/detect.md section 6: coarse passes, candidates, a look at each."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fairlead.detect.agreement import Agreement, RoughModel, agreement
from fairlead.detect.keypoints import Keypoints, LandmarkNetwork
from fairlead.detect.onnx.session import MULTIPLE_PX
from fairlead.detect.roi import projected_square
from fairlead.detect.window import Window, window_about
from fairlead.opencv import Image
from fairlead.pnp import MIN_POINTS

MAX_CANDIDATES = 3
"""Of one pass that are looked at."""
LOOKS = 3
"""At a candidate, each framed by what the one before it found."""
FINE_LOOKS = 8
"""At squares of the pass after the last, for each image: a target of few pixels is found a few images later."""
MIN_FINE_PX = 48
"""No smaller squares are searched."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Sighting:
    """What one look at a window found."""

    window: Window
    keypoints: Keypoints
    """Pixels of the image."""
    agreement: Agreement | None


@dataclass(frozen=True, kw_only=True)
class _Candidate:
    middle: tuple[float, float]
    side: float
    rank: float


def look(network: LandmarkNetwork, model: RoughModel, image: Image, window: Window, threshold: float) -> Sighting:
    """Run the network on a window; which pose do the landmarks above the threshold agree with?"""
    keypoints = network.look(window.cut(image)).in_image(window)
    seen = keypoints.above(threshold)
    found = agreement(model, keypoints, seen, window, weights(network, keypoints))
    return Sighting(window=window, keypoints=keypoints, agreement=found)


def weights(network: LandmarkNetwork, keypoints: Keypoints) -> np.ndarray:
    """(n,) how surely each is seen: the logistic function of a logit, 1 for peaks, whose height has no such meaning."""
    if network.card.decoding.kind != "pixels":
        return np.ones(len(keypoints.scores))
    with np.errstate(over="ignore", invalid="ignore"):
        return np.nan_to_num(1.0 / (1.0 + np.exp(-keypoints.scores)))


def acquire(network: LandmarkNetwork, model: RoughModel, image: Image, attempt: int = 0) -> Sighting | None:
    """The target anywhere in the image, or None. The passes go from coarse to fine and end with the first success.

    `attempt` counts the images that were searched in vain: the pass after the last one is shared among them.
    """
    settings = network.card.acquisition
    height, width = image.shape[:2]
    passes = [tuple(scan(width, height, level, network)) for level in range(settings.levels)]
    for windows in (*passes, fine_share(width, height, settings.levels, network, attempt)):
        candidates: list[_Candidate] = []
        for window in windows:
            sighting = look(network, model, image, window, settings.visible_threshold)
            candidates += _candidates(network, model, sighting)
        for candidate in _best(candidates):
            sighting = _examine(network, model, image, candidate)
            if sighting is not None:
                return sighting
    return None


def scan(width: int, height: int, level: int, network: LandmarkNetwork) -> Iterator[Window]:
    """The windows of one pass: squares of the longer side over 2^level, half overlapping; one large window where the
    network takes any size.
    """
    w, h = network.size
    side = max(width, height) / 2.0**level
    if network.card.input.any_size:
        scale = min(w, h) / side
        size = tuple(max(1, -(-round(scale * each) // MULTIPLE_PX)) * MULTIPLE_PX for each in (width, height))
        extent = tuple(max(1, round(each / scale)) for each in size)
        corner = ((width - extent[0]) // 2, (height - extent[1]) // 2)
        yield Window(corner=corner, extent=(extent[0], extent[1]), size=(size[0], size[1]))
        return
    yield from _squares(width, height, side, network.size)


def fine_share(width: int, height: int, level: int, network: LandmarkNetwork, attempt: int) -> tuple[Window, ...]:
    """Of the squares of a pass FINE_LOOKS, other ones at each attempt."""
    side = max(width, height) / 2.0**level
    squares = tuple(_squares(width, height, side, network.size)) if side >= MIN_FINE_PX else ()
    first = (attempt * FINE_LOOKS) % max(1, len(squares))
    return squares[first : first + FINE_LOOKS]


def _squares(width: int, height: int, side: float, size: tuple[int, int]) -> Iterator[Window]:
    for v in _centres(height, side):
        for u in _centres(width, side):
            yield window_about(np.array([u, v]), side, size)


def _centres(length: int, side: float) -> np.ndarray:
    """Of squares that cover a length, neighbours overlapping by at least half."""
    steps = int(np.ceil(2.0 * max(length / side - 1.0, 0.0))) + 1
    first = 0.5 * min(side, length) - 0.5
    return np.linspace(first, length - 1 - first, steps)


def _candidates(network: LandmarkNetwork, model: RoughModel, sighting: Sighting) -> list[_Candidate]:
    """A square about what agrees with a pose, if there is one, then one about where most of the landmarks are."""
    found: list[_Candidate] = []
    agreed = sighting.agreement
    if agreed is not None:
        square = _square(model, agreed)
        if square is not None:
            rank = 1.0 + float(np.count_nonzero(agreed.inliers))
            found.append(_Candidate(middle=square[0], side=square[1], rank=rank))
    seen = sighting.keypoints.above(network.card.acquisition.visible_threshold) & model.known
    crowd = _crowd(sighting.keypoints.pixels[seen], sighting.window)
    if crowd is not None:
        middle, side, count = crowd
        found.append(_Candidate(middle=middle, side=side, rank=float(count)))
    return found


def _crowd(pixels: np.ndarray, window: Window) -> tuple[tuple[float, float], float, int] | None:
    """The square with more keypoints than chance would put there, by the binomial law: n KL(k/n || share of the area).

    Squares about each keypoint that reach to each other one are compared. None for fewer than four keypoints.
    """
    n = len(pixels)
    if n < MIN_POINTS:
        return None
    reach = np.sort(np.abs(pixels[:, None] - pixels).max(axis=2), axis=1)  # (n, n), the first is 0
    area = float(np.prod(window.extent))
    share = np.clip((2.0 * reach + 1.0) ** 2 / area, 1e-9, 1.0 - 1e-9)
    k = (np.arange(n) + 1.0) / n
    with np.errstate(divide="ignore", invalid="ignore"):
        rest = np.where(k < 1.0, (1.0 - k) * np.log((1.0 - k) / (1.0 - share)), 0.0)
    gain = np.where((k > share) & (np.arange(n) >= MIN_POINTS - 1), k * np.log(k / share) + rest, -np.inf)
    i, j = np.unravel_index(int(np.argmax(gain)), gain.shape)
    if not np.isfinite(gain[i, j]):
        return None
    near = pixels[np.abs(pixels - pixels[i]).max(axis=1) <= reach[i, j]]
    low, high = near.min(axis=0), near.max(axis=0)
    middle = 0.5 * (low + high)
    return (float(middle[0]), float(middle[1])), float((high - low).max()), len(near)


def _square(model: RoughModel, agreed: Agreement) -> tuple[tuple[float, float], float] | None:
    return projected_square(model.X_target[model.known], model.camera, agreed.T_camera_target)


def _best(candidates: list[_Candidate]) -> list[_Candidate]:
    """The highest ranks, none twice."""
    kept: list[_Candidate] = []
    for candidate in sorted(candidates, key=lambda each: -each.rank):
        if len(kept) < MAX_CANDIDATES and not any(_alike(candidate, other) for other in kept):
            kept.append(candidate)
    return kept


def _alike(a: _Candidate, b: _Candidate) -> bool:
    apart = max(abs(p - q) for p, q in zip(a.middle, b.middle, strict=True))
    larger = max(a.side, b.side)
    return apart < 0.15 * larger and min(a.side, b.side) > 0.8 * larger


def _examine(network: LandmarkNetwork, model: RoughModel, image: Image, candidate: _Candidate) -> Sighting | None:
    """Look, frame anew by what was found, and believe a look that was framed well."""
    card = network.card
    needed = min(card.acquisition.min_landmarks, int(np.count_nonzero(model.known)))
    frame = candidate
    for _ in range(LOOKS):
        window = window_about(np.array(frame.middle), card.input.pad * frame.side, network.size)
        sighting = look(network, model, image, window, card.calibration.visible_threshold)
        better = _candidates(network, model, sighting)
        if not better:
            return None
        settled = sighting.agreement is not None and _alike(better[0], frame)
        if settled and believed(sighting, needed, card.acquisition.min_score):
            return sighting
        if settled:
            return None
        frame = better[0]
    return None


def believed(sighting: Sighting, min_landmarks: int, min_score: float) -> bool:
    """Enough landmarks agree, and enough of those that should be in the window are seen."""
    agreed = sighting.agreement
    if agreed is None:
        return False
    return int(np.count_nonzero(agreed.inliers)) >= min_landmarks and agreed.score >= min_score
