# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Finding the target in a whole image, docs/detect.md section 6: coarse passes, candidates, a look at each."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fairlead.detect.agreement import Agreement, RoughModel, agreement
from fairlead.detect.keypoints import Keypoints
from fairlead.detect.onnx import Network
from fairlead.detect.onnx.session import MULTIPLE_PX
from fairlead.detect.roi import projected_square
from fairlead.detect.window import Window, window_about
from fairlead.opencv import Image

MAX_CANDIDATES = 3
"""Of one pass that are looked at."""
LOOKS = 3
"""At a candidate, each framed by what the one before it found."""
_SETTLED = 0.1
"""Share of the side by which the frame may be off for a look to count."""


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


def look(network: Network, model: RoughModel, image: Image, window: Window, threshold: float) -> Sighting:
    """Run the network on a window; which pose do the landmarks above the threshold agree with?"""
    keypoints = network.look(window.cut(image)).in_image(window)
    seen = keypoints.above(threshold)
    found = agreement(model, keypoints, seen, window, weights(network, keypoints))
    return Sighting(window=window, keypoints=keypoints, agreement=found)


def weights(network: Network, keypoints: Keypoints) -> np.ndarray:
    """(n,) how surely each is seen: the logistic function of a logit, 1 for peaks, whose height has no such meaning."""
    if network.card.decoding.kind != "pixels":
        return np.ones(len(keypoints.scores))
    with np.errstate(over="ignore", invalid="ignore"):
        return np.nan_to_num(1.0 / (1.0 + np.exp(-keypoints.scores)))


def acquire(network: Network, model: RoughModel, image: Image) -> Sighting | None:
    """The target anywhere in the image, or None. The passes go from coarse to fine and end with the first success."""
    settings = network.card.acquisition
    for level in range(settings.levels):
        candidates: list[_Candidate] = []
        for window in scan(image.shape[1], image.shape[0], level, network):
            sighting = look(network, model, image, window, settings.visible_threshold)
            candidates += _candidates(network, model, sighting)
        for candidate in _best(candidates):
            sighting = _examine(network, model, image, candidate)
            if sighting is not None:
                return sighting
    return None


def scan(width: int, height: int, level: int, network: Network) -> Iterator[Window]:
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
    for v in _centres(height, side):
        for u in _centres(width, side):
            yield window_about(np.array([u, v]), side, network.size)


def _centres(length: int, side: float) -> np.ndarray:
    """Of squares that cover a length, neighbours overlapping by at least half."""
    steps = int(np.ceil(2.0 * max(length / side - 1.0, 0.0))) + 1
    first = 0.5 * min(side, length) - 0.5
    return np.linspace(first, length - 1 - first, steps)


def _candidates(network: Network, model: RoughModel, sighting: Sighting) -> list[_Candidate]:
    """A square about what agrees with a pose, and one about where most of the landmarks are."""
    found: list[_Candidate] = []
    agreed = sighting.agreement
    if agreed is not None:
        square = _square(model, agreed)
        if square is not None:
            rank = 1.0 + float(np.count_nonzero(agreed.inliers))
            found.append(_Candidate(middle=square[0], side=square[1], rank=rank))
    seen = sighting.keypoints.above(network.card.acquisition.visible_threshold) & model.known
    if np.count_nonzero(seen) >= 4:
        z = sighting.keypoints.pixels[seen]
        middle = np.median(z, axis=0)
        away = np.abs(z - middle).max(axis=1)
        near = away <= 2.5 * np.median(away)
        middle = 0.5 * (z[near].min(axis=0) + z[near].max(axis=0))
        side = float(np.ptp(z[near], axis=0).max())
        rank = float(weights(network, sighting.keypoints)[seen][near].sum())
        found.append(_Candidate(middle=(float(middle[0]), float(middle[1])), side=side, rank=rank))
    return found


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


def _examine(network: Network, model: RoughModel, image: Image, candidate: _Candidate) -> Sighting | None:
    """Look, frame anew by the pose that was found, and believe the look that was framed well."""
    settings = network.card.acquisition
    middle, side = candidate.middle, candidate.side
    for _ in range(LOOKS):
        window = window_about(np.array(middle), network.card.input.pad * side, network.size)
        sighting = look(network, model, image, window, network.card.calibration.visible_threshold)
        square = None if sighting.agreement is None else _square(model, sighting.agreement)
        if square is None:
            return None
        apart = max(abs(p - q) for p, q in zip(square[0], middle, strict=True))
        settled = apart < _SETTLED * square[1] and abs(square[1] / max(side, 1.0) - 1.0) < 2.0 * _SETTLED
        middle, side = square
        if settled:
            needed = min(settings.min_landmarks, int(np.count_nonzero(model.known)))
            return sighting if believed(sighting, needed, settings.min_score) else None
    return None


def believed(sighting: Sighting, min_landmarks: int, min_score: float) -> bool:
    """Enough landmarks agree, and enough of those that should be in the window are seen."""
    agreed = sighting.agreement
    if agreed is None:
        return False
    return int(np.count_nonzero(agreed.inliers)) >= min_landmarks and agreed.score >= min_score
