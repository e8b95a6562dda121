# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The card of a network: what is read, and what is refused in one line."""

from pathlib import Path

import pytest

from fairlead.io.errors import InputError
from fairlead.io.network_card import (
    Acquisition,
    Calibration,
    Decoding,
    NetworkCard,
    NetworkInput,
    card_from_json,
    card_json,
    load_card,
)

FOREIGN = """
format = 1
name = "my RTMPose"
landmarks = ["a", "b", "c", "d"]

[input]
name = "input"
width = 192
height = 256
mean = [123.675, 116.28, 103.53]
std = [58.395, 57.12, 57.375]

[decoding]
kind = "simcc"

[calibration]
sigma_px = 2.0
visible_threshold = 0.3
"""


def test_a_short_card_is_enough(tmp_path: Path) -> None:
    path = tmp_path / "m.toml"
    path.write_text(FOREIGN)
    card = load_card(path)
    assert card.input.color == "RGB"
    assert (card.input.width, card.input.height, card.input.any_size) == (192, 256, False)
    assert card.decoding == Decoding(kind="simcc")
    assert card.per_landmark(card.calibration.sigma_px).tolist() == [2.0] * 4


def test_a_card_survives_its_metadata() -> None:
    card = NetworkCard(
        name="n",
        network="heat-t",
        target="frigate",
        landmarks=("a", "b"),
        input=NetworkInput(name="x", width=256, height=256, mean=(1.0, 2.0, 3.0), std=(4.0, 5.0, 6.0), any_size=True),
        decoding=Decoding(outputs=("p", "c", "v")),
        calibration=Calibration(scale=(1.5, 2.5), floor_px=0.1, tail_dof=4.0, visible_threshold=-0.5),
        acquisition=Acquisition(levels=4, min_landmarks=8, min_score=0.4),
    )
    assert card_from_json(card_json(card), Path("x.onnx")) == card


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("format = 1", "format = 2", "format: expected 1, got 2"),
        ("format = 1", "", "format: missing"),
        ("width = 192", "width = 1.5", "input.width: expected a whole number"),
        ("width = 192", "width = 100000", "input.width: expected a whole number from 8 to 4096"),
        ("mean = [123.675, 116.28, 103.53]", "mean = [1.0]", "input.mean: expected 3 numbers"),
        ("57.375]", "0.0]", "input.std: expected numbers above 0"),
        ('kind = "simcc"', 'kind = "sim"', "decoding.kind: expected one of pixels, simcc, heatmap"),
        ('kind = "simcc"', 'kind = "simcc"\noutputs = ["x"]', "decoding.outputs: expected 2 names"),
        ("sigma_px = 2.0", "", "calibration.sigma_px: missing"),
        ("sigma_px = 2.0", "sigma_px = [1.0, 2.0]", "calibration.sigma_px: expected one number or 4"),
        ("sigma_px = 2.0", "sigma_px = -1.0", "calibration.sigma_px: expected one number or 4, none below"),
        ("sigma_px = 2.0", "sigma_pix = 2.0", "did you mean 'sigma_px'"),
        ('["a", "b", "c", "d"]', '["a", "a"]', "landmarks: expected 1 to 2048 different names"),
        ('["a", "b", "c", "d"]', "[1, 2]", "landmarks: expected a list of names"),
        ('name = "input"', 'name = "input"\nany_size = 1', "input.any_size: expected true or false"),
        ('name = "input"', 'name = "input"\npad = 0.5', "input.pad: expected 1 to 4"),
        ("[calibration]", "[acquisition]\nlevels = 9\n[calibration]", "acquisition.levels: expected a whole number"),
    ],
)
def test_a_wrong_card_is_refused_with_its_key(tmp_path: Path, old: str, new: str, said: str) -> None:
    path = tmp_path / "m.toml"
    assert old in FOREIGN
    path.write_text(FOREIGN.replace(old, new))
    with pytest.raises(InputError) as error:
        load_card(path)
    assert said in str(error.value)


@pytest.mark.parametrize("text", ["", "{", "[]", "1", '{"format": 1}', "[" * 100_000])
def test_metadata_that_are_no_card(text: str) -> None:
    with pytest.raises(InputError):
        card_from_json(text, Path("x.onnx"))
