# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""From crops to a file: a network learns, is taken up again, is exported, and says the same at run time."""

import hashlib
import shutil
from pathlib import Path

import numpy as np
import onnx
import onnxruntime
import pytest
import torch

from fairlead.cli import main
from fairlead.detect.onnx import Network
from fairlead.train.checkpoint import load_lesson, read_checkpoint
from fairlead.train.course import Course
from fairlead.train.crops import normalise, open_crops
from fairlead.train.curves import read_curves
from fairlead.train.export import export_network, write_onnx
from fairlead.train.lesson import Lesson, share_of_rate
from fairlead.train.start import warm_start
from tests.unit.train.conftest import NAMES, spotted

SPOTS = torch.from_numpy(np.stack([spotted(np.random.default_rng(k))[0] for k in range(8)])).permute(0, 3, 1, 2)


def test_a_network_learns_where_spots_are(trained: Path) -> None:
    """The loss falls by more than its own spread, in the second part from where the first had ended."""
    losses = read_curves(trained)["train/loss"]
    assert losses[:, 0].tolist() == [10.0, 20.0, 30.0, 40.0]
    losses = losses[:, 1].tolist()
    assert losses[2] < losses[0]
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


def test_settling_changes_covariance_and_visibility_alone(trained: Path) -> None:
    kept, settled = (read_checkpoint(trained / name)["state_dict"] for name in ("last.ckpt", "settled.ckpt"))
    changed = {name for name in kept if not torch.equal(kept[name], settled[name])}
    assert changed == {name for name in kept if name.startswith("network.landmark.")}
    assert (trained / "settled.ckpt").stat().st_mtime >= (trained / "last.ckpt").stat().st_mtime


@pytest.fixture(scope="module")
def exported(trained: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("export") / "spots.onnx"
    checkpoint = str(trained / "settled.ckpt")
    assert main(["export", checkpoint, "--target", "spots", "--min-score", "0.7", "-o", str(path)]) == 0
    return path


def test_the_file_says_what_it_is(exported: Path) -> None:
    digest, name = (exported.parent / "spots.onnx.sha256").read_text().split()
    assert (digest, name) == (hashlib.sha256(exported.read_bytes()).hexdigest(), "spots.onnx")
    card = Network(exported).card
    assert (card.network, card.target, card.landmarks) == ("heat-t", "spots", NAMES)
    assert card.acquisition.min_score == 0.7
    assert (card.input.color, card.input.width, card.input.height, card.input.any_size) == ("BGR", 128, 128, True)


def test_the_run_time_sees_what_was_trained(trained: Path, exported: Path) -> None:
    """From an 8 bit crop to pixels and covariances, normalisation and order of colours included; single precision."""
    lesson, image = load_lesson(trained / "settled.ckpt"), spotted(np.random.default_rng(7))[0]
    with torch.inference_mode():
        wanted = lesson(torch.from_numpy(image).permute(2, 0, 1)[None])
    found = Network(exported).look(image)
    assert np.abs(found.pixels - wanted.pixels[0].numpy()).max() < 0.001
    l11, l22, l21 = (wanted.cholesky[0, :, k].double().numpy() for k in range(3))
    xx, xy, yy = np.exp(2.0 * l11), np.exp(l11) * l21, l21**2 + np.exp(2.0 * l22)
    assert np.allclose(found.covariances.reshape(-1, 4), np.column_stack([xx, xy, xy, yy]), rtol=1e-3)
    assert np.allclose(found.scores, wanted.visible[0].numpy(), atol=1e-3)


@pytest.mark.parametrize("name", ["heat-t", "rtmpose-t", "tinypose"])
def test_torch_and_onnxruntime_say_the_same(name: str, trained: Path, spots: Path, tmp_path: Path) -> None:
    """Two orders of summation: 0.001 px. heat is trained, or which cell is highest would be luck; the maps of an
    untrained tinypose are flat, and one Newton step divides by their curvature: 0.02 px.
    """
    torch.manual_seed(0)
    lesson = load_lesson(trained / "last.ckpt") if name == "heat-t" else Lesson(name, NAMES, 1, rate=1e-3, size=128)
    lesson.eval()
    write_onnx(lesson, tmp_path / "network.onnx")
    images = torch.from_numpy(np.stack([spotted(np.random.default_rng(k))[0] for k in (5, 6)])).permute(0, 3, 1, 2)
    with torch.inference_mode():
        wanted = lesson(images)
    found = onnxruntime.InferenceSession(tmp_path / "network.onnx").run(None, {"image": normalise(images).numpy()})
    for one, other in zip(found, (wanted.pixels, wanted.cholesky, wanted.visible), strict=True):
        assert one.shape == tuple(other.shape)
        assert np.abs(one - other.numpy()).max() < (0.02 if name == "tinypose" else 0.001)


def test_weights_that_fit_are_taken_over(trained: Path) -> None:
    """RTMPose begins from heat's backbone."""
    lesson = Lesson("rtmpose-t", NAMES, 1, rate=1e-3, size=128)
    taken, of = warm_start(lesson, trained / "last.ckpt", SPOTS)
    kept = read_checkpoint(trained / "last.ckpt")["state_dict"]
    backbone = [name for name in lesson.state_dict() if ".backbone." in name]
    assert len(backbone) <= taken < of
    assert all(torch.equal(lesson.state_dict()[name], kept[name]) for name in backbone)


@pytest.mark.parametrize("name", ["heat-t", "rtmpose-t", "tinypose"])
def test_an_exported_network_can_be_begun_from(
    name: str, trained: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Batch norms, which the file has no more, come back so that the network says the same, and so that while learning
    it says the same of the crops that they were measured on. Heat is trained; tinypose as in the test above.
    """
    torch.manual_seed(0)
    lesson = load_lesson(trained / "settled.ckpt") if name == "heat-t" else Lesson(name, NAMES, 1, rate=1e-3, size=128)
    for module in lesson.modules():
        if isinstance(module, torch.nn.BatchNorm2d) and name != "heat-t":
            module.running_var.uniform_(0.5, 2.0)
            module.running_mean.normal_(0.0, 0.1)
    monkeypatch.setattr("fairlead.train.export.load_lesson", lambda _: lesson.eval())
    export_network(tmp_path / "any.ckpt", tmp_path / "network.onnx")
    again = Lesson(name, NAMES, 1, rate=1e-3, size=128)
    taken, of = warm_start(again, tmp_path / "network.onnx", SPOTS)
    counters = sum(key.endswith("num_batches_tracked") for key in again.state_dict())
    fixed = sum(key.endswith("blur.across") for key in again.state_dict())
    assert of - counters - fixed <= taken <= of - counters
    with torch.inference_mode():
        wanted, found, learning = lesson.eval()(SPOTS), again.eval()(SPOTS), again.train()(SPOTS)
    for each in (found, learning):
        assert (each.pixels - wanted.pixels).abs().median() < 0.001
        assert torch.allclose(each.cholesky, wanted.cholesky, atol=0.002)
        assert torch.allclose(each.present, wanted.present, atol=0.002)


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
    begun = Course(network="heat-t", output=Path(), crops=40_960, start=Path("a.onnx"))
    assert [begun.size_at(epoch) for epoch in range(10)] == [256] * 10


def test_the_rate_rises_stays_and_falls() -> None:
    shares = [share_of_rate(step, 1000) for step in (0, 25, 51, 500, 750, 999)]
    assert shares == pytest.approx([1 / 51, 26 / 51, 1.0, 1.0, 0.51, 0.02], abs=0.001)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["train", "--data", "{spots}", "--target", "{frigate}", "-o", "{out}"], "expected the landmarks of"),
        (["train", "--data", "{out}", "-o", "{out}"], "annotations.json"),
        (["train", "--data", "{spots}", "--size", "100", "-o", "{out}"], "--size a multiple of 128"),
        (["train", "--data", "{spots}", "--crops", "0", "-o", "{out}"], "whole numbers above 0"),
        (["train", "--data", "{spots}", "--start", "{broken}", "-o", "{out}"], "expected a checkpoint"),
        (["train", "--data", "{spots}", "--start", "{torn}", "-o", "{out}"], "expected an .onnx file"),
        (["train", "--data", "{spots}", "--start", "{bare}", "-o", "{out}"], "one without its card"),
        (["export", "{broken}", "-o", "{out}/a.onnx"], "expected a checkpoint"),
        (["export", "{broken}", "--min-score", "1.2", "-o", "{out}/a.onnx"], "--min-score from 0 to 1, got 1.2"),
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
    torn, bare = tmp_path / "torn.onnx", tmp_path / "bare.onnx"
    shutil.copy(broken, torn)
    onnx.save(onnx.helper.make_model(onnx.helper.make_graph([], "nothing", [], [])), bare)
    places = {
        "torn": torn, "bare": bare, "spots": spots, "frigate": repository / "data" / "frigate" / "target.toml",
        "broken": broken, "out": tmp_path / "out",
    }  # fmt: skip
    assert main([argument.format(**places) for argument in arguments]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
