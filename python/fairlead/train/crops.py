# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Folders of labelled crops as data for training. docs/networks.md section 4."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor
from torch.utils.data import Dataset

from fairlead.io.coco import LabelledImage, read_coco
from fairlead.io.errors import InputError
from fairlead.opencv import read_image
from fairlead.train.augment import NONE, Augmentation, augment
from fairlead.train.labels import Batch

HELD_OUT = 0.05
"""Share of the data, at their end, that is not trained on where no held-out folders are given."""
MEAN, SCALE = 118.0, 58.0
"""Grey levels; one for all colours, so that a grey camera does as well."""


@dataclass(frozen=True, kw_only=True)
class Example:
    """One crop as the network gets it."""

    image: np.ndarray
    pixels: np.ndarray
    visibility: np.ndarray


@dataclass(frozen=True, kw_only=True)
class Labelled:
    """A picture and its labels."""

    path: Path
    label: LabelledImage


class Crops(Dataset[Example]):
    """Pictures with labels. What is drawn of crop i in epoch e depends on seed, e and i alone."""

    def __init__(
        self,
        landmarks: tuple[str, ...],
        pictures: Sequence[Labelled],
        *,
        size: int,
        spread: Augmentation = NONE,
        seed: int = 0,
    ) -> None:
        self.landmarks, self.size, self.spread, self.seed, self.epoch = landmarks, size, spread, seed, 0
        self._pictures = tuple(pictures)

    def __len__(self) -> int:
        return len(self._pictures)

    def __getitem__(self, index: int) -> Example:
        picture = self._pictures[index]
        rng = np.random.default_rng([self.seed, self.epoch, index])
        image, pixels, visibility = augment(
            read_image(picture.path), picture.label.pixels, np.array(picture.label.visibility, np.int64),
            size=self.size, spread=self.spread, rng=rng,
        )  # fmt: skip
        return Example(image=image, pixels=pixels, visibility=visibility)


def read_folders(folders: Sequence[Path]) -> tuple[tuple[str, ...], list[Labelled]]:
    """Landmarks and pictures of folders that `fairlead render crops` or an annotator wrote.

    Raises InputError where there are none, or where a folder labels other landmarks than the first.
    """
    landmarks: tuple[str, ...] = ()
    pictures: list[Labelled] = []
    for folder in folders:
        names, labels = read_coco(folder / "annotations.json")
        if landmarks and names != landmarks:
            raise InputError(folder, f"expected labels of {', '.join(landmarks)}, as in {folders[0]}")
        landmarks = names
        pictures += [Labelled(path=folder / label.file_name, label=label) for label in labels]
    if not pictures:
        raise InputError(folders[0] if folders else Path(), "expected labelled crops, got none")
    return landmarks, pictures


def open_crops(data: Sequence[Path], valid: Sequence[Path], *, size: int, seed: int) -> tuple[Crops, Crops]:
    """Crops to train with, changed anew every time, and held-out ones, as they are. Raises InputError."""
    landmarks, pictures = read_folders(data)
    if valid:
        names, held_out = read_folders(valid)
        if names != landmarks:
            raise InputError(valid[0], f"expected labels of {', '.join(landmarks)}, as in {data[0]}")
    else:
        count = max(1, round(HELD_OUT * len(pictures)))
        pictures, held_out = pictures[:-count], pictures[-count:]
        if not pictures:
            raise InputError(data[0], "expected more than one crop, or --valid")
    return (
        Crops(landmarks, pictures, size=size, spread=Augmentation(), seed=seed),
        Crops(landmarks, held_out, size=size),
    )


def collate(examples: Sequence[Example]) -> Batch:
    """Examples to one batch."""
    return Batch(
        images=torch.from_numpy(np.stack([each.image for each in examples])).permute(0, 3, 1, 2),
        pixels=torch.from_numpy(np.stack([each.pixels for each in examples])).float(),
        visibility=torch.from_numpy(np.stack([each.visibility for each in examples])),
    )


def normalise(images: Tensor) -> Tensor:
    """8 bit (b, 3, h, w), blue green red, to about zero mean and unit variance."""
    return (images.float() - MEAN) / SCALE
