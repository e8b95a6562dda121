# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Networks in the forms that others export them in, with a short card beside them: read as their own code reads them.

mmdeploy's RTMPose gives the rows of SimCC, paddle2onnx's PP-TinyPose one map a landmark; neither decodes.
"""

import warnings
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from fairlead.detect.onnx import Network
from fairlead.train.networks.rtmpose import RtmPose, row_expectation
from fairlead.train.networks.tinypose import TinyPose, dark
from tests.unit.train.conftest import NAMES

CARD = """
format = 1
name = "of another"
landmarks = {landmarks}

[input]
name = "{input}"
width = 96
height = 128
mean = [123.675, 116.28, 103.53]
std = [58.395, 57.12, 57.375]

[decoding]
{decoding}

[calibration]
sigma_px = 2.5
"""


class Maps(nn.Module):
    """What is published of a network, without our heads."""

    def __init__(self, network: RtmPose | TinyPose) -> None:
        super().__init__()
        self.network = network

    def forward(self, images: Tensor) -> tuple[Tensor, ...]:
        """(1, 3, h, w), normalised."""
        return self.network(images).maps


def exported(network: nn.Module, folder: Path, name: str, outputs: list[str], decoding: str) -> Network:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        torch.onnx.export(
            Maps(network).eval(), (torch.zeros(1, 3, 128, 96),), folder / "other.onnx", dynamo=False, opset_version=17,
            input_names=[name], output_names=outputs,
        )  # fmt: skip
    card = CARD.format(landmarks=list(NAMES), input=name, decoding=decoding).replace("'", '"')
    (folder / "other.toml").write_text(card)
    return Network(folder / "other.onnx")


def normalised(image: np.ndarray) -> Tensor:
    """Red green blue, with the mean and spread of ImageNet."""
    x = (image[..., ::-1] - [123.675, 116.28, 103.53]) / [58.395, 57.12, 57.375]
    return torch.from_numpy(x).float().permute(2, 0, 1)[None]


IMAGE = np.random.default_rng(3).integers(0, 256, (128, 96, 3), np.uint8)


def test_rtmpose_as_mmdeploy_exports_it(tmp_path: Path) -> None:
    torch.manual_seed(1)
    network = RtmPose(len(NAMES), "t", (96, 128)).eval()
    found = exported(network, tmp_path, "input", ["simcc_x", "simcc_y"], 'kind = "simcc"\nwindow = 16').look(IMAGE)
    with torch.inference_mode():
        rows = network(normalised(IMAGE)).maps
    wanted = torch.stack([row_expectation(row)[0] for row in rows], dim=-1)[0].numpy()
    assert np.abs(found.pixels - wanted).max() < 0.01
    assert np.allclose(found.covariances, 2.5**2 * np.eye(2))


def test_tinypose_as_paddle2onnx_exports_it(tmp_path: Path) -> None:
    """Its maps are labelled at x / 4, ours at the centres of the cells: 1.5 px. Derivatives of DARK are taken over one
    cell or two, which is the same for a peak that is a Gaussian.
    """
    torch.manual_seed(1)
    network = TinyPose(len(NAMES)).eval()
    plant(network)
    found = exported(network, tmp_path, "image", ["maps"], 'kind = "heatmap"').look(IMAGE)
    with torch.inference_mode():
        heat = network(normalised(IMAGE)).maps[0]
    wanted = dark(heat, network.blur)[0].numpy() - 1.5
    assert heat.shape == (1, len(NAMES), 32, 24)
    assert np.ptp(wanted, axis=0).min() > 4.0
    assert np.abs(found.pixels - wanted).max() < 0.1


def plant(network: TinyPose) -> None:
    """Maps with one smooth peak each, which an untrained network does not have: spread what it says, and lift it."""
    conv = network.heat
    blur = nn.Conv2d(len(NAMES), len(NAMES), 13, padding=6, groups=len(NAMES), bias=False)
    across = torch.exp(-0.5 * (torch.arange(-6.0, 7.0) / 2.0) ** 2)
    blur.weight.data[:] = across[:, None] * across
    sharpened = nn.Sequential(conv, Sparse(), blur)
    network.heat = sharpened  # type: ignore[assignment]


class Sparse(nn.Module):
    """The highest cell alone."""

    def forward(self, x: Tensor) -> Tensor:
        """(b, n, h, w)"""
        return (x >= x.amax((2, 3), keepdim=True)).to(x.dtype)
