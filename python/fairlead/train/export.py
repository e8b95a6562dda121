# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A trained network as one .onnx file with its card inside: ready for `fairlead track --detector`. docs/networks.md."""

import hashlib
import warnings
from pathlib import Path

import onnx
import torch
from torch import Tensor, nn

from fairlead.io.network_card import (
    METADATA_KEY,
    Acquisition,
    Calibration,
    Decoding,
    NetworkCard,
    NetworkInput,
    card_json,
)
from fairlead.train.calibrate import read_calibration
from fairlead.train.checkpoint import load_lesson
from fairlead.train.crops import MEAN, SCALE
from fairlead.train.lesson import Lesson

OPSET = 17
INPUT = "image"
OUTPUTS = ("pixels", "cholesky", "visible")
ACQUISITION = Acquisition(min_score=0.6)
"""These networks say how surely the target is there, so that the share that must be seen can be asked for in full."""
FREE = {0: "batch", 2: "height", 3: "width"}


class _Outputs(nn.Module):
    """A tuple for the exporter instead of a record."""

    def __init__(self, network: nn.Module) -> None:
        super().__init__()
        self.network = network

    def forward(self, images: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """(b, 3, h, w), normalised -> pixels (b, n, 2), cholesky (b, n, 3), visible (b, n)."""
        found = self.network(images)
        return found.pixels, found.cholesky, found.visible


def export_network(checkpoint: Path, output: Path, *, calibration: Path | None = None, target: str = "") -> str:
    """Write the .onnx file, whole or not at all, and its .sha256; returns the sha256. Raises InputError."""
    lesson = load_lesson(checkpoint)
    found = Calibration() if calibration is None else read_calibration(calibration, len(lesson.landmarks))
    output.parent.mkdir(parents=True, exist_ok=True)
    part = output.with_name(f".{output.name}.part")
    write_onnx(lesson, part)
    model = onnx.load(part)
    onnx.helper.set_model_props(model, {METADATA_KEY: card_json(_card(lesson, output.stem, found, target))})
    onnx.checker.check_model(model)
    onnx.save(model, part)
    digest = hashlib.sha256(part.read_bytes()).hexdigest()
    part.replace(output)
    output.with_name(output.name + ".sha256").write_text(f"{digest}  {output.name}\n", encoding="utf-8")
    return digest


def write_onnx(lesson: Lesson, path: Path) -> None:
    """The graph alone: image, normalised, to pixels, cholesky and visible."""
    network = _Outputs(lesson.network).eval()  # the exporter puts back the mode that it found
    image = torch.zeros(1, 3, lesson.size, lesson.size)
    axes = {INPUT: FREE} if lesson.any_size else {INPUT: {0: "batch"}}
    axes |= {name: {0: "batch"} for name in OUTPUTS}
    with warnings.catch_warnings():
        # The newer exporter needs a package of its own and writes the same operators.
        warnings.simplefilter("ignore")
        torch.onnx.export(
            network, (image,), path, dynamo=False, opset_version=OPSET, input_names=[INPUT],
            output_names=list(OUTPUTS), dynamic_axes=axes,
        )  # fmt: skip


def _card(lesson: Lesson, name: str, calibration: Calibration, target: str) -> NetworkCard:
    return NetworkCard(
        name=name,
        network=lesson.name,
        target=target,
        landmarks=lesson.landmarks,
        input=NetworkInput(
            name=INPUT,
            width=lesson.size,
            height=lesson.size,
            color="BGR",
            mean=(MEAN, MEAN, MEAN),
            std=(SCALE, SCALE, SCALE),
            any_size=lesson.any_size,
        ),
        decoding=Decoding(kind="pixels"),
        calibration=calibration,
        acquisition=ACQUISITION,
    )
