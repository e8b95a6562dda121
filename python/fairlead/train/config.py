# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What train, calibrate and export are told. Nothing heavy is imported here."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional, arg

Network = Literal["heat-t", "heat-s", "heat-m", "rtmpose-t", "rtmpose-s", "rtmpose-m", "tinypose"]


@dataclass(frozen=True, kw_only=True)
class TrainConfig:
    """Train a landmark network on labelled crops. Goes on where it stopped."""

    data: tuple[Path, ...]
    """Folders of crops with annotations.json, as `fairlead render crops` writes them."""
    output: Annotated[Path, arg(aliases=["-o"])]
    """Folder for checkpoints and curves; a course that was stopped in it is taken up again."""
    target: Path | None = None
    """target.toml whose landmarks the crops must be labelled with."""
    network: Network = "heat-t"
    """heat: the default. rtmpose: as published, best begun with --start from a trained heat. tinypose: smallest."""
    start: Path | None = None
    """Checkpoint or exported .onnx to begin from: weights of the same name and shape are taken over."""
    valid: tuple[Path, ...] = ()
    """Folders of held-out crops; the last twentieth of the data if not given."""
    crops: int = 100_000
    """Crops that the network sees in all, each changed anew; more is better, and costs time in proportion."""
    batch: int = 32
    """Crops of one step."""
    rate: float = 1e-3
    """Learning rate; too large diverges, too small wastes crops [-]."""
    size: int = 256
    """Side of the crops [px], a multiple of 128."""
    threads: int | None = None
    """Of the processor; all that it has if not given."""
    workers: int = 1
    """Processes that read crops."""
    precision: Literal["auto", "32", "bf16", "16"] = "auto"
    """Of the arithmetic: auto is 16 on a GPU and 32 without; bf16 is faster on some processors."""
    settle: int = 8192
    """Crops on which, after the course, covariance and visibility alone learn on; 0: none."""
    seed: int = 0
    """Of everything that is drawn by chance."""


@dataclass(frozen=True, kw_only=True)
class CalibrateConfig:
    """Measure a trained network on held-out images: errors, and what its covariances are worth."""

    checkpoint: Positional[Path]
    """Written by train."""
    data: tuple[Path, ...]
    """Folders of crops, or of rendered sequences; none that was trained on. One condition each."""
    output: Annotated[Path, arg(aliases=["-o"])]
    """Folder for calibration.toml, tables and figures."""
    target: Path | None = None
    """target.toml whose landmarks the network knows; the frigate's if not given."""
    camera: Path | None = None
    """The flight's calibration, for errors in its pixels; camera.yaml beside the target if not given."""
    seed: int = 0
    """Of how windows are misplaced in the images of sequences."""


@dataclass(frozen=True, kw_only=True)
class ExportConfig:
    """Write a trained network as one .onnx file that says itself how to use it."""

    checkpoint: Positional[Path]
    """Written by train."""
    output: Annotated[Path, arg(aliases=["-o"])]
    """The .onnx file; its sha256 is written beside it."""
    calibration: Path | None = None
    """calibration.toml of `fairlead calibrate`; without it covariances are as the network says."""
    target: str = ""
    """Name of the target, for the card."""
    min_score: float = 0.5
    """What acquisition asks for before it believes, 0 to 1: higher mistakes fewer other things for the target [-]."""


NetworkConfig = TrainConfig | CalibrateConfig | ExportConfig
