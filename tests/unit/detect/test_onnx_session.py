# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Files of networks: what is taken, and the one line for what is not."""

import hashlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper

from fairlead.detect.onnx import Network
from fairlead.io.errors import InputError
from fairlead.io.network_card import METADATA_KEY, Decoding, NetworkCard, NetworkInput
from fairlead.opencv import Image
from tests.unit.detect.networks import COLOURS, NAMES, heat_network, heatmap_network, saved, simcc_network
from tests.unit.detect.spots import spot

Maker = Callable[[tuple[int, int]], onnx.ModelProto]
MEAN_STD = NetworkInput(name="image", width=256, height=256, std=(255.0, 255.0, 255.0), any_size=True)
CARD = NetworkCard(name="spots", landmarks=NAMES, input=MEAN_STD)
FOREIGN = f"""
format = 1
name = "spots"
landmarks = {list(NAMES)}
[input]
name = "image"
width = 192
height = 256
std = [255, 255, 255]
"""
SIMCC = FOREIGN + '[decoding]\nkind = "simcc"\nbeta = 0\nwindow = 24\n[calibration]\nsigma_px = 0.5\n'
HEATMAP = FOREIGN + '[decoding]\nkind = "heatmap"\n[calibration]\nsigma_px = 0.5\n'


def spots(width: int, height: int) -> tuple[Image, np.ndarray]:
    """One spot of each colour, at places that are no whole pixels."""
    light = np.zeros((height, width, 3))
    places = np.array([[30, 40], [90, 40], [150, 40], [30, 120], [90, 120], [150, 120], [90, 200]]) + 0.37
    for place, colour in zip(places, COLOURS, strict=True):
        spot(light, place, 7.0, colour)
    return np.round(light).astype(np.uint8), places


def test_a_network_with_its_card_inside(tmp_path: Path) -> None:
    network = Network(saved(heat_network(CARD), tmp_path / "n.onnx"))
    for width, height in ((256, 256), (320, 288)):
        image, places = spots(width, height)
        found = network.look(image)
        assert np.abs(found.pixels - places).max() < 0.05
        assert found.above(0.0).all()
        L = np.array([[0.5, 0.0], [0.1, 0.25]])
        assert found.covariances == pytest.approx(np.tile(L @ L.T, (len(NAMES), 1, 1)), rel=1e-5)
    assert not network.look(np.zeros((256, 256, 3), np.uint8)).above(0.0).any()


@pytest.mark.parametrize(("make", "text"), [(simcc_network, SIMCC), (heatmap_network, HEATMAP)])
def test_networks_of_others_work_with_a_short_card(tmp_path: Path, make: Maker, text: str) -> None:
    path = saved(make((192, 256)), tmp_path / "foreign.onnx")
    path.with_suffix(".toml").write_text(text)
    image, places = spots(192, 256)
    found = Network(path).look(image)
    assert np.abs(found.pixels - places).max() < 0.1
    assert found.above(0.2).all()
    assert found.covariances == pytest.approx(np.tile(0.25 * np.eye(2), (len(NAMES), 1, 1)))


def test_the_order_of_colours_is_the_cards(tmp_path: Path) -> None:
    image, places = spots(256, 256)
    blue_first = NetworkCard(name="s", landmarks=NAMES, input=NetworkInput(**(vars(MEAN_STD) | {"color": "BGR"})))
    found = Network(saved(heat_network(blue_first), tmp_path / "n.onnx")).look(image)
    swapped = [NAMES.index(name) for name in ("blue", "green", "red", "cyan", "magenta", "yellow", "white")]
    assert np.abs(found.pixels - places[swapped]).max() < 0.05


def test_mean_and_std_are_grey_levels_in_the_cards_order(tmp_path: Path) -> None:
    mean, std = (10.0, 20.0, 30.0), (2.0, 4.0, 5.0)
    special = NetworkInput(name="image", width=256, height=256, mean=mean, std=std, any_size=True)
    path = saved(heat_network(NetworkCard(name="s", landmarks=NAMES, input=special)), tmp_path / "n.onnx")
    blob = Network(path).blob(np.full((32, 32, 3), (90, 60, 30), np.uint8))  # blue, green, red
    assert blob.dtype == np.float32
    assert blob[0, :, 0, 0] == pytest.approx([(30 - 10) / 2, (60 - 20) / 4, (90 - 30) / 5])


def test_the_sum_beside_the_file_is_checked(tmp_path: Path) -> None:
    path = saved(heat_network(CARD), tmp_path / "n.onnx")
    beside = tmp_path / "n.onnx.sha256"
    beside.write_text(f"{hashlib.sha256(path.read_bytes()).hexdigest()}  n.onnx\n")
    Network(path)
    content = bytearray(path.read_bytes())
    content[content.index(b"spots")] ^= 1
    path.write_bytes(content)
    assert "damaged or another file: expected sha256" in refusal(path)
    beside.write_text("not a sum")
    assert "expected a sha256" in refusal(path)


def test_the_sum_in_a_card_is_checked(tmp_path: Path) -> None:
    path = saved(simcc_network((192, 256)), tmp_path / "n.onnx")
    path.with_suffix(".toml").write_text('sha256 = "' + "0" * 64 + '"\n' + SIMCC)
    assert "damaged or another file" in refusal(path)


def refusal(path: Path) -> str:
    """The one line."""
    with pytest.raises(InputError) as error:
        Network(path)
    message = str(error.value)
    assert "\n" not in message
    return message


def test_files_that_are_no_networks(tmp_path: Path) -> None:
    path = tmp_path / "n.onnx"
    assert "cannot be read" in refusal(path)
    for content in (b"", b"no network at all", bytes(1000), b"\x08\x08" * 5000):
        path.write_bytes(content)
        assert "the runtime refuses it" in refusal(path)


def test_a_network_without_a_card(tmp_path: Path) -> None:
    path = saved(heat_network(None), tmp_path / "n.onnx")
    assert "carries no card, and n.toml is not beside it" in refusal(path)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('name = "image"', 'name = "input"', "expected one input 'input' as its card says, got image"),
        ("width = 192", "width = 256", "input image: expected (1, 3, 256, 256)"),
        ("width = 192", "width = 192\nany_size = true", "input image: expected (1, 3, any, any)"),
        (
            'kind = "simcc"',
            'kind = "simcc"\noutputs = ["x", "y"]',
            "outputs: expected x, y for kind simcc, got simcc_x",
        ),
        ('kind = "simcc"', 'kind = "heatmap"', "outputs: expected one with four dimensions for kind heatmap"),
        ('kind = "simcc"', 'kind = "pixels"', "outputs: expected pixels, cholesky, visible for kind pixels"),
        ("beta = 0", "bins_per_px = 4", "output simcc_x: expected floats (1, 7, 768), got float32 (1, 7, 384)"),
        (", 'white'", "", "output simcc_x: expected floats (1, 6, 384), got float32 (1, 7, 384)"),
    ],
)
def test_a_card_that_speaks_of_another_network(tmp_path: Path, old: str, new: str, said: str) -> None:
    path = saved(simcc_network((192, 256)), tmp_path / "n.onnx")
    assert old in SIMCC
    path.with_suffix(".toml").write_text(SIMCC.replace(old, new))
    assert said in refusal(path)


def test_a_network_that_asks_for_another_type(tmp_path: Path) -> None:
    image = helper.make_tensor_value_info("image", TensorProto.UINT8, (1, 3, 256, 192))
    outputs = [helper.make_tensor_value_info(n, TensorProto.UINT8, (1, 3, 256, 192)) for n in ("simcc_x", "simcc_y")]
    nodes = [helper.make_node("Identity", ["image"], [o.name]) for o in outputs]
    graph = helper.make_graph(nodes, "g", [image], outputs)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9)
    path = saved(model, tmp_path / "n.onnx")
    path.with_suffix(".toml").write_text(SIMCC)
    assert "tensor(float), got (1, 3, 256, 192) tensor(uint8)" in refusal(path)


def test_weights_outside_the_file_are_not_fetched(tmp_path: Path) -> None:
    model = heat_network(CARD)
    (tmp_path / "inside").mkdir()
    secret = tmp_path / "secret"
    secret.write_bytes(bytes(4 * 21))
    weights = next(each for each in model.graph.initializer if len(each.dims) == 4)
    weights.ClearField("raw_data")
    weights.data_location = TensorProto.EXTERNAL
    weights.external_data.add(key="location", value="../secret")
    path = saved(model, tmp_path / "inside" / "n.onnx")
    assert "the runtime refuses it" in refusal(path)


def test_damaged_files_never_do_more_than_say_so(tmp_path: Path) -> None:
    """Bytes changed, cut off, doubled: an InputError of one line, or a network that still has its card's form."""
    content = saved(heat_network(CARD), tmp_path / "n.onnx").read_bytes()
    rng = np.random.default_rng(5)
    path, refused = tmp_path / "m.onnx", 0
    for trial in range(300):
        mutated = bytearray(content)
        for _ in range(int(rng.integers(1, 12))):
            mutated[int(rng.integers(len(mutated)))] = int(rng.integers(256))
        if trial % 5 == 0:
            mutated = mutated[: int(rng.integers(len(mutated)))]
        path.write_bytes(mutated)
        try:
            found = Network(path).look(np.zeros((256, 256, 3), np.uint8))
        except InputError:
            refused += 1
        else:
            assert found.pixels.shape == (len(NAMES), 2)
    assert refused > 100


def test_malformed_metadata_is_one_line(tmp_path: Path) -> None:
    model = heat_network(None)
    helper.set_model_props(model, {METADATA_KEY: '{"format": 1, "name": '})
    assert "malformed JSON" in refusal(saved(model, tmp_path / "n.onnx"))


def test_heatmaps_of_several_outputs_need_a_name(tmp_path: Path) -> None:
    model = heatmap_network((192, 256))
    model.graph.node.append(helper.make_node("Identity", ["conv_0.tmp_1"], ["more"]))
    model.graph.output.append(helper.make_tensor_value_info("more", TensorProto.FLOAT, (1, len(NAMES), 64, 48)))
    onnx.checker.check_model(model)
    path = saved(model, tmp_path / "n.onnx")
    path.with_suffix(".toml").write_text(HEATMAP)
    assert "outputs: expected conv_0.tmp_1, more for kind heatmap" in refusal(path)
    path.with_suffix(".toml").write_text(HEATMAP.replace('"heatmap"', '"heatmap"\noutputs = ["more"]'))
    Network(path)


def test_pixels_need_no_second_name_for_what_they_are_called(tmp_path: Path) -> None:
    renamed = heat_network(None)
    for node in renamed.graph.node:
        node.output[:] = ["where" if each == "pixels" else each for each in node.output]
    renamed.graph.output[0].name = "where"
    path = saved(renamed, tmp_path / "n.onnx")
    text = FOREIGN.replace("width = 192", "width = 256\nany_size = true")
    path.with_suffix(".toml").write_text(text)
    assert "outputs: expected pixels" in refusal(path)
    path.with_suffix(".toml").write_text(text + '[decoding]\noutputs = ["where", "cholesky", "visible"]\n')
    assert Network(path).card.decoding == Decoding(outputs=("where", "cholesky", "visible"))
