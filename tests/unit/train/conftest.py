# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Crops that teach quickly: four spots of their own colours on a dark, grainy ground."""

from pathlib import Path

import numpy as np
import pytest

from fairlead.cli import main
from fairlead.io.coco import LabelledImage, label_json, write_coco
from fairlead.opencv.filters import write_image
from fairlead.train import course as courses

COLOURS = np.array([[255, 60, 60], [60, 255, 60], [60, 60, 255], [255, 255, 60]], float)
NAMES = ("blue", "green", "red", "cyan")
SIDE = 128


def spotted(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """A picture (side, side, 3) and where its four spots are (4, 2)."""
    places = rng.uniform(24.0, SIDE - 24.0, (4, 2))
    v, u = np.mgrid[:SIDE, :SIDE]
    image = rng.uniform(20.0, 60.0, (SIDE, SIDE, 1)) * np.ones(3)
    for (x, y), colour in zip(places, COLOURS, strict=True):
        cover = np.exp(-0.5 * ((u - x) ** 2 + (v - y) ** 2) / 3.0**2)[..., None]
        image = (1.0 - cover) * image + cover * colour
    return np.rint(image).astype(np.uint8), places


def write_spots(folder: Path, count: int, seed: int = 0) -> Path:
    """A folder of such crops, labelled; one spot in ten is said to be hidden."""
    (folder / "images").mkdir(parents=True)
    rng = np.random.default_rng(seed)
    labels = []
    for number in range(count):
        image, places = spotted(rng)
        name = f"images/{number:06d}.jpg"
        write_image(folder / name, image, quality=95)
        T = np.eye(4)
        T[2, 3] = 100.0 + number
        label = LabelledImage(
            number=number, file_name=name, width=SIDE, height=SIDE, pixels=places,
            visibility=tuple(np.where(rng.random(4) < 0.1, 1, 2).tolist()), box=(0.0, 0.0, 128.0, 128.0),
            K=np.diag([500.0, 500.0, 1.0]), T_camera_target=T,
        )  # fmt: skip
        labels.append(label_json(label))
    write_coco(folder / "annotations.json", "spots", NAMES, labels)
    return folder


@pytest.fixture(scope="session")
def spots(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_spots(tmp_path_factory.mktemp("spots") / "crops", 192)


TRAIN = [
    "train",
    "--crops",
    "640",
    "--batch",
    "16",
    "--size",
    "128",
    "--threads",
    "1",
    "--workers",
    "0",
    "--rate",
    "3e-3",
    "--seed",
    "4",
]


@pytest.fixture(scope="session")
def trained(spots: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a short course of the default network, in two parts."""
    output = tmp_path_factory.mktemp("course")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(courses, "EPOCH", 160)
        stopped = ("--crops", "320")
        assert main([*TRAIN, *stopped, "--data", str(spots), "-o", str(output)]) == 0
        assert main([*TRAIN, "--data", str(spots), "-o", str(output)]) == 0
    return output
