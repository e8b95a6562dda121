# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What a network found in held-out pictures, beside the truth: one row per landmark of each picture."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields

import numpy as np
import torch

from fairlead.design_effect import pose_jacobian
from fairlead.progress import Progress
from fairlead.train.lesson import Lesson
from fairlead.train.pictures import Picture, seen_from
from fairlead.types import Points3

BATCH = 16


@dataclass(frozen=True, kw_only=True, eq=False)
class Findings:
    """m rows; pixels of the crop if not said otherwise."""

    condition: np.ndarray
    """(m,) index of the folder."""
    picture: np.ndarray
    """(m,) number of the picture in it."""
    landmark: np.ndarray
    """(m,) index."""
    visibility: np.ndarray
    """(m,): 0 outside the crop, 1 hidden, 2 visible."""
    error: np.ndarray
    """(m, 2) found - true; NaN outside."""
    cholesky: np.ndarray
    """(m, 3): log l11, log l22, l21."""
    visible: np.ndarray
    """(m,) logit."""
    unit: np.ndarray
    """(m,) pixels of the flight's image for one of the crop."""
    range_m: np.ndarray
    azimuth_deg: np.ndarray
    jacobian: np.ndarray
    """(m, 2, 6) pixels by the pose's xi; of the target as it was told."""

    def where(self, mask: np.ndarray) -> "Findings":
        """Some of the rows."""
        return Findings(**{each.name: getattr(self, each.name)[mask] for each in fields(self)})

    @property
    def distance(self) -> np.ndarray:
        """(m,) [px of the crop]."""
        return np.linalg.norm(self.error, axis=1)

    @property
    def covariance(self) -> np.ndarray:
        """(m, 2, 2) as the network says [px^2 of the crop]."""
        l11, l22, l21 = np.exp(self.cholesky[:, 0]), np.exp(self.cholesky[:, 1]), self.cholesky[:, 2]
        xy = l11 * l21
        return np.stack([l11**2, xy, xy, l21**2 + l22**2], axis=1).reshape(-1, 2, 2)


def joined(parts: Sequence[Findings]) -> Findings:
    """One table of several."""
    return Findings(**{each.name: np.concatenate([getattr(p, each.name) for p in parts]) for each in fields(Findings)})


def look(
    lesson: Lesson, pictures: Iterable[Picture], *, condition: int, focal_px: float, positions: Points3,
    advance: Progress,
) -> Findings:  # fmt: skip
    """Run the network over pictures; `positions` (n, 3) of the landmarks, ranges are measured to their middle."""
    middle = 0.5 * (positions.min(axis=0) + positions.max(axis=0))
    parts: list[Findings] = []
    number = 0
    for batch in _batches(pictures):
        images = torch.from_numpy(np.stack([each.image for each in batch])).permute(0, 3, 1, 2)
        with torch.inference_mode():
            found = lesson(images)
        pixels, cholesky, visible = (
            each.double().numpy() for each in (found.pixels, found.cholesky, found.visible)
        )  # fmt: skip
        for k, each in enumerate(batch):
            n = len(each.pixels)
            range_m, azimuth_deg = seen_from(each.T_camera_target, middle)
            parts.append(
                Findings(
                    condition=np.full(n, condition),
                    picture=np.full(n, number),
                    landmark=np.arange(n),
                    visibility=each.visibility,
                    error=np.where(each.visibility[:, None] > 0, pixels[k] - each.pixels, np.nan),
                    cholesky=cholesky[k],
                    visible=visible[k],
                    unit=np.full(n, focal_px / each.focal_px),
                    range_m=np.full(n, range_m),
                    azimuth_deg=np.full(n, azimuth_deg),
                    jacobian=pose_jacobian(each.camera, each.T_camera_target, positions),
                )
            )
            number += 1
        advance(len(batch))
    return joined(parts)


def _batches(pictures: Iterable[Picture]) -> Iterator[list[Picture]]:
    batch: list[Picture] = []
    for each in pictures:
        batch.append(each)
        if len(batch) == BATCH:
            yield batch
            batch = []
    if batch:
        yield batch
