# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""To begin where another network ended: a checkpoint, or a network that was exported. docs/networks.md section 4.

An exported network has no batch norms any more: they are folded into the convolutions before them,

    W' = s W,  b' = b - s m,  s = g / sqrt(v + eps)

so they come back with the mean 0 and the scale 1, and `remeasure` then gives them those of data, as training wants.
"""

from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import onnx
import torch
from onnx import numpy_helper
from torch import Tensor, nn

from fairlead.io.errors import InputError
from fairlead.io.network_card import METADATA_KEY, card_from_json
from fairlead.train.checkpoint import read_checkpoint
from fairlead.train.lesson import Lesson

EXPORTED = ".onnx"


def warm_start(lesson: Lesson, path: Path, images: Tensor) -> tuple[int, int]:
    """Take over every weight whose name and shape fit; returns how many of how many. Raises InputError.

    `images` (b, 3, h, w), 8 bit: what batch norms are measured on where the file has none.
    """
    exported = path.suffix == EXPORTED
    found = exported_weights(path) if exported else read_checkpoint(path)["state_dict"]
    own = lesson.state_dict()
    fitting = {name: value for name, value in found.items() if name in own and own[name].shape == value.shape}
    if not fitting:
        raise InputError(path, "no weight in it fits this network")
    lesson.load_state_dict(fitting, strict=False)
    if exported:
        remeasure(lesson, images)
    return len(fitting), len(own)


def exported_weights(path: Path) -> dict[str, Tensor]:
    """The weights in an .onnx file of `fairlead export` by their names in a checkpoint. Raises InputError."""
    try:
        model = onnx.load(path)
    except Exception as error:  # a damaged file fails in many ways
        raise InputError(path, f"expected an .onnx file, got {type(error).__name__}") from error
    metadata = {each.key: each.value for each in model.metadata_props}
    if METADATA_KEY not in metadata:
        raise InputError(path, "expected an .onnx file of `fairlead export`, got one without its card")
    card = card_from_json(metadata[METADATA_KEY], path)
    try:
        names = Lesson(card.network, card.landmarks, 1, rate=1e-3, size=card.input.width).state_dict()
    except ValueError as error:
        raise InputError(path, str(error)) from error
    arrays = {each.name: torch.from_numpy(np.array(numpy_helper.to_array(each))) for each in model.graph.initializer}
    for node in model.graph.node:
        if node.op_type == "Identity" and node.input[0] in arrays:  # equal arrays are kept once
            arrays[node.output[0]] = arrays[node.input[0]]
    found = {name: value for name, value in arrays.items() if name in names}
    for node in model.graph.node:
        if node.op_type not in {"Conv", "MatMul"} or node.input[1] not in arrays:
            continue
        module, weight = module_of(node.name), arrays[node.input[1]]
        found[f"{module}.weight"] = weight.T if node.op_type == "MatMul" else weight
        if len(node.input) > 2 and f"{module}.bias" not in names:
            found |= _plain_norm(module, arrays[node.input[2]])
    return {name: value for name, value in found.items() if name in names}


def module_of(node: str) -> str:
    """`/network/stem/stem.0/stem.0.0/Conv` -> `network.stem.0.0`."""
    parts: list[str] = []
    for part in node.strip("/").split("/")[:-1]:
        if parts and part.startswith(f"{parts[-1]}."):
            parts.pop()
        parts.append(part)
    return ".".join(parts)


def _plain_norm(convolution: str, bias: Tensor) -> Mapping[str, Tensor]:
    """The batch norm that follows in the same sequence and does nothing but add."""
    before, _, place = convolution.rpartition(".")
    norm, one = f"{before}.{int(place) + 1}", torch.ones_like(bias)
    variance = one - nn.BatchNorm2d(1).eps
    values = {"weight": one, "bias": bias, "running_mean": torch.zeros_like(bias), "running_var": variance}
    return {f"{norm}.{name}": value for name, value in values.items()}


def remeasure(network: nn.Module, images: Tensor) -> None:
    """Every batch norm gets mean and variance of what comes in, and the scale and offset that change nothing."""

    def measure(norm: nn.Module, inputs: tuple[Tensor, ...]) -> None:
        assert isinstance(norm, nn.BatchNorm2d)
        assert norm.running_mean is not None
        assert norm.running_var is not None
        variance, mean = torch.var_mean(inputs[0].float(), dim=(0, 2, 3), correction=0)
        scale = norm.weight / torch.sqrt(norm.running_var + norm.eps)
        norm.bias.add_(scale * (mean - norm.running_mean))
        norm.weight.copy_(scale * torch.sqrt(variance + norm.eps))
        norm.running_mean.copy_(mean)
        norm.running_var.copy_(variance)

    network.eval()
    with torch.no_grad(), ExitStack() as hooks:
        for module in network.modules():
            if isinstance(module, nn.BatchNorm2d):
                hooks.callback(module.register_forward_pre_hook(measure).remove)
        network(images)
    network.train()
