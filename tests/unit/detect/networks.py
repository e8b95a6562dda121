# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Small networks that really look: each landmark is a spot of its own colour, found by its colour.

They have the forms of what people have: fully convolutional with covariances, SimCC as mmdeploy exports it, heatmaps
as paddle2onnx exports them. Colours are the corners of the colour cube, black being the background.
"""

from pathlib import Path

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

from fairlead.io.network_card import METADATA_KEY, NetworkCard, card_json

COLOURS = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, 0, 1], [0, 1, 1], [1, 1, 1]], np.float32)
"""Red, green, blue of the landmarks."""
NAMES = ("red", "green", "blue", "yellow", "magenta", "cyan", "white")
N = len(NAMES)
_RELIEF = 0.9
"""Response to a landmark's own colour; half of it to nothing else."""


class Graph:
    """Nodes and constants of a network, one after the other."""

    def __init__(self) -> None:
        self.nodes: list[onnx.NodeProto] = []
        self.constants: list[onnx.TensorProto] = []

    def constant(self, values: object, dtype: type = np.float32) -> str:
        """Name of a constant."""
        name = f"c{len(self.constants)}"
        self.constants.append(numpy_helper.from_array(np.array(values, dtype=dtype), name))
        return name

    def add(self, kind: str, *inputs: str, output: str | None = None, **attributes: object) -> str:
        """Name of a node's output."""
        name = output or f"n{len(self.nodes)}"
        self.nodes.append(helper.make_node(kind, list(inputs), [name], **attributes))
        return name

    def model(
        self, size: tuple[int, int] | None, outputs: dict[str, tuple[object, ...]], card: NetworkCard | None
    ) -> onnx.ModelProto:
        """The finished network; any size if none is given."""
        sides: tuple[object, object] = ("h", "w") if size is None else (size[1], size[0])
        image = helper.make_tensor_value_info("image", TensorProto.FLOAT, (1, 3, *sides))
        infos = [helper.make_tensor_value_info(name, TensorProto.FLOAT, shape) for name, shape in outputs.items()]
        graph = helper.make_graph(self.nodes, "spots", [image], infos, self.constants)
        model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9)
        if card is not None:
            helper.set_model_props(model, {METADATA_KEY: card_json(card)})
        onnx.checker.check_model(model)
        return model


def responses(graph: Graph) -> str:
    """(1, n, h, w): how much of each landmark's colour a pixel has; the image comes as red, green, blue from 0 to 1."""
    own = COLOURS.sum(axis=1)
    weights = graph.constant((2.0 * COLOURS - 1.0)[:, :, None, None])
    return graph.add("Relu", graph.add("Conv", "image", weights, graph.constant(_RELIEF - own)))


def heat_network(card: NetworkCard | None, size: tuple[int, int] | None = None) -> onnx.ModelProto:
    """Kind pixels: the middle of each colour, sigmas of 0.5 and 0.25 px, correlated; seen where there is any."""
    graph = Graph()
    r = responses(graph)
    mass = graph.add("ReduceSum", r, graph.constant([2, 3], np.int64), keepdims=0)
    safe = graph.add("Max", mass, graph.constant(1e-3))
    ones = graph.add("Add", graph.add("Mul", r, graph.constant(0.0)), graph.constant(1.0))
    coordinates: list[str] = []
    for axis in (3, 2):
        at = graph.add("Sub", graph.add("CumSum", ones, graph.constant(axis, np.int64)), graph.constant(1.0))
        sums = graph.add("ReduceSum", graph.add("Mul", r, at), graph.constant([2, 3], np.int64), keepdims=0)
        mean = graph.add("Div", sums, safe)
        coordinates.append(graph.add("Unsqueeze", mean, graph.constant([2], np.int64)))
    graph.add("Concat", *coordinates, axis=2, output="pixels")
    nothing = graph.add("Mul", graph.add("Unsqueeze", mass, graph.constant([2], np.int64)), graph.constant(0.0))
    told = graph.constant([[[np.log(0.5), np.log(0.25), 0.1]]])
    graph.add("Add", nothing, told, output="cholesky")
    graph.add("Mul", graph.add("Sub", mass, graph.constant(1.0)), graph.constant(4.0), output="visible")
    return graph.model(size, {"pixels": (1, N, 2), "cholesky": (1, N, 3), "visible": (1, N)}, card)


def simcc_network(size: tuple[int, int]) -> onnx.ModelProto:
    """Kind simcc, mmdeploy's names: the colours summed along rows and columns, two bins a pixel, bin i at i / 2 px."""
    graph = Graph()
    r = responses(graph)
    shapes: dict[str, tuple[object, ...]] = {}
    for name, axis, length in (("simcc_x", 2, size[0]), ("simcc_y", 3, size[1])):
        profile = graph.add("ReduceSum", r, graph.constant([axis], np.int64), keepdims=0)
        scales = graph.constant([1.0, 1.0, 2.0])
        graph.add(
            "Resize", profile, "", scales, output=name, mode="linear", coordinate_transformation_mode="asymmetric"
        )
        shapes[name] = (1, N, 2 * length)
    return graph.model(size, shapes, None)


def heatmap_network(size: tuple[int, int]) -> onnx.ModelProto:
    """Kind heatmap: Gaussian of 8 px, every fourth pixel; cell i at 4 i px. A second output that nobody asked for."""
    graph = Graph()
    r = responses(graph)
    bell = np.exp(-0.5 * (np.arange(-24, 25) / 8.0) ** 2)
    kernel = np.repeat(np.outer(bell, bell)[None, None] / 60.0, N, axis=0)
    maps = graph.add(
        "Conv", r, graph.constant(kernel), output="conv_0.tmp_1", group=N, strides=[4, 4], pads=[24, 24, 24, 24]
    )
    graph.add("ReduceMax", maps, output="peak", axes=[2, 3], keepdims=0)
    shapes = {"conv_0.tmp_1": (1, N, size[1] // 4, size[0] // 4), "peak": (1, N)}
    return graph.model(size, shapes, None)


def saved(model: onnx.ModelProto, path: Path) -> Path:
    """Write the file."""
    path.write_bytes(model.SerializeToString())
    return path
