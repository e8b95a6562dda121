# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""From crops to a file: a network learns, is taken up again, is exported, and says the same at run time."""

import csv
import hashlib
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import onnxruntime
import pytest
import torch

from fairlead.cli import main
from fairlead.config import TrainConfig, UsageError
from fairlead.detect.onnx import session
from fairlead.io.network_card import card_from_json
from fairlead.train import course as courses
from fairlead.train.course import Course, load_lesson, read_checkpoint
from fairlead.train.crops import normalise, open_crops
from fairlead.train.lesson import Lesson, share_of_rate
from tests.unit.train.conftest import NAMES, spotted


def test_a_network_learns_where_spots_are(trained: Path) -> None:
    """The loss falls by more than its own spread, in the second part from where the first had ended."""
    losses = []
    for part in ("curves_0", "curves_1"):
        with (trained / part / "metrics.csv").open() as stream:
            losses += [float(row["train/loss"]) for row in csv.DictReader(stream) if row["train/loss"]]
    assert len(losses) == 4
    assert losses == sorted(losses, reverse=True)
    assert losses[-1] < 0.7 * losses[0]
    assert (trained / "curves.png").stat().st_size > 10_000


def test_what_is_kept_is_the_average_and_its_network(trained: Path) -> None:
    kept = read_checkpoint(trained / "last.ckpt")
    assert kept["global_step"] == 40
    assert kept["hyper_parameters"]["landmarks"] == NAMES
    best = read_checkpoint(trained / "best.ckpt")
    assert any((best["state_dict"][k] != best["current_model_state"][k]).any() for k in best["state_dict"])
    lesson = load_lesson(trained / "last.ckpt")
    assert not lesson.training
    assert lesson.size == 128


@pytest.fixture(scope="module")
def exported(trained: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("export") / "spots.onnx"
    assert main(["export", str(trained / "last.ckpt"), "--target", "spots", "-o", str(path)]) == 0
    return path


def test_the_file_says_what_it_is(exported: Path) -> None:
    """Card and sha256; the run time reads it."""
    text = onnxruntime.InferenceSession(exported).get_modelmeta().custom_metadata_map["fairlead_card"]
    card = card_from_json(text, exported)
    assert (card.network, card.target, card.landmarks) == ("heat-t", "spots", NAMES)
    assert (card.input.color, card.input.width, card.input.any_size) == ("BGR", 128, True)
    digest, name = (exported.parent / "spots.onnx.sha256").read_text().split()
    assert (digest, name) == (hashlib.sha256(exported.read_bytes()).hexdigest(), "spots.onnx")
    assert session is not None


@pytest.mark.parametrize("name", ["heat-t", "rtmpose-t", "tinypose"])
def test_torch_and_onnxruntime_say_the_same(name: str, trained: Path, spots: Path, tmp_path: Path) -> None:
    """Two orders of summation: 1e-3 px. heat is trained, or which cell is highest would be a matter of luck."""
    from fairlead.train.export import write_onnx

    torch.manual_seed(0)
    lesson = load_lesson(trained / "last.ckpt") if name == "heat-t" else Lesson(name, NAMES, 1, rate=1e-3, size=128)
    lesson.eval()
    write_onnx(lesson, tmp_path / "network.onnx")
    images = torch.from_numpy(np.stack([spotted(np.random.default_rng(k))[0] for k in (5, 6)])).permute(0, 3, 1, 2)
    with torch.inference_mode():
        wanted = lesson(images)
    found = onnxruntime.InferenceSession(tmp_path / "network.onnx").run(None, {"image": normalise(images).numpy()})
    for one, other, tolerance in zip(
        found, (wanted.pixels, wanted.cholesky, wanted.visible), (1e-3, 1e-3, 1e-3), strict=True
    ):
        assert one.shape == tuple(other.shape)
        assert np.abs(one - other.numpy()).max() < tolerance


def test_weights_that_fit_are_taken_over(trained: Path, spots: Path, tmp_path: Path) -> None:
    """RTMPose begins from heat's backbone."""
    lesson = Lesson("rtmpose-t", NAMES, 1, rate=1e-3, size=128)
    taken, of = courses.warm_start(lesson, trained / "last.ckpt")
    kept = read_checkpoint(trained / "last.ckpt")["state_dict"]
    backbone = [name for name in lesson.state_dict() if ".backbone." in name]
    assert len(backbone) <= taken < of
    assert all(torch.equal(lesson.state_dict()[name], kept[name]) for name in backbone)


def test_crops_are_drawn_anew_in_every_epoch(spots: Path) -> None:
    learned, held_out = open_crops([spots], (), size=128, seed=3)
    assert (len(learned), len(held_out)) == (182, 10)
    first, again = learned[0], learned[0]
    assert np.array_equal(first.image, again.image)
    learned.epoch = 1
    assert not np.array_equal(first.image, learned[0].image)
    assert np.array_equal(held_out[0].image, held_out[0].image)


def test_small_crops_come_first() -> None:
    sizes = [Course(network="heat-t", output=Path(), crops=40_960).size_at(epoch) for epoch in range(10)]
    assert sizes == [128] * 5 + [192] * 2 + [256] * 3
    assert Course(network="rtmpose-t", output=Path(), crops=40_960).size_at(0) == 256


@pytest.mark.parametrize("wrong", [{"size": 100}, {"crops": 0}, {"rate": 0.0}, {"data": ()}])
def test_arguments_out_of_range_are_named(wrong: dict[str, Any], spots: Path) -> None:
    with pytest.raises(UsageError, match="train: "):
        TrainConfig(**{"data": (spots,), "output": Path("out")} | wrong)


def test_the_rate_rises_stays_and_falls() -> None:
    shares = [share_of_rate(step, 1000) for step in (0, 25, 51, 500, 750, 999)]
    assert shares == pytest.approx([1 / 51, 26 / 51, 1.0, 1.0, 0.51, 0.02], abs=0.001)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["train", "--data", "{spots}", "--target", "{frigate}", "-o", "{out}"], "expected the landmarks of"),
        (["train", "--data", "{out}", "-o", "{out}"], "annotations.json"),
        (["train", "--data", "{spots}", "--start", "{broken}", "-o", "{out}"], "expected a checkpoint"),
        (["export", "{broken}", "-o", "{out}/a.onnx"], "expected a checkpoint"),
        (["calibrate", "{broken}", "--data", "{spots}", "-o", "{out}"], "expected a checkpoint"),
    ],
)
def test_what_cannot_be_used_is_one_line_and_2(
    arguments: list[str],
    message: str,
    spots: Path,
    repository: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    broken = tmp_path / "broken.ckpt"
    shutil.copy(spots / "images" / "000000.jpg", broken)
    places = {
        "spots": spots, "frigate": repository / "data" / "frigate" / "target.toml", "broken": broken,
        "out": tmp_path / "out",
    }  # fmt: skip
    assert main([argument.format(**places) for argument in arguments]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
