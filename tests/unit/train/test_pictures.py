# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Windows of a sequence keep the half pixels: what is labelled is where the label says."""

from pathlib import Path

import numpy as np
import pytest

from fairlead.cli import main
from fairlead.io.bop import BopFrame, write_bop
from fairlead.io.errors import InputError
from fairlead.io.target import load_target, save_target
from fairlead.opencv.filters import write_image
from fairlead.train.pictures import COLUMNS, open_pictures, seen_from
from fairlead.types import Target
from tests.unit.train.conftest import COLOURS, NAMES


def sequence(folder: Path, spread: float) -> Path:
    """Four spots in an image of 400 x 300 px, twice; the fourth is outside in the second."""
    (folder / "rgb").mkdir(parents=True)
    v, u = np.mgrid[:300, :400]
    T = np.eye(4)
    T[2, 3] = 50.0
    frames, lines = [], [",".join(COLUMNS)]
    for number in (0, 1):
        places = np.array([200.3, 140.8]) + spread * np.array([[-1.0, -0.5], [1.0, 0.3], [0.2, 1.0], [0.5, -0.4]])
        image = np.zeros((300, 400, 3))
        for k, ((x, y), colour) in enumerate(zip(places, COLOURS, strict=True)):
            image += np.exp(-0.5 * ((u - x) ** 2 + (v - y) ** 2) / (0.06 * spread) ** 2)[..., None] * colour
            state = "visible" if k != 3 else ("hidden", "outside")[number]
            lines.append(f"{number},0,{NAMES[k]},{x},{y},50,{state}")
        write_image(folder / "rgb" / f"{number:06d}.png", np.clip(np.rint(image), 0, 255).astype(np.uint8))
        K = np.array([[500.0, 0.0, 199.5], [0.0, 500.0, 149.5], [0.0, 0.0, 1.0]])
        frames.append(BopFrame(frame=number, K=K, T_camera_target=T))
    write_bop(folder, frames)
    (folder / "landmarks_true.csv").write_text("\n".join(lines) + "\n")
    target = Target(name="spots", landmarks=NAMES, positions=np.eye(4)[:, :3], covariance=np.zeros((12, 12)))
    save_target(folder / "target_true.toml", target)
    return folder


@pytest.mark.parametrize("spread", [30.0, 120.0])
def test_windows_of_a_sequence_are_labelled(spread: float, tmp_path: Path) -> None:
    """Enlarged (30 px) and shrunk (120 px); 0.3 px is an eighth of a pixel of the image times the enlargement."""
    count, pictures = open_pictures(sequence(tmp_path / "flight", spread), NAMES, 128, seed=0)
    assert count == 2
    for number, picture in enumerate(pictures):
        assert picture.image.shape == (128, 128, 3)
        assert picture.visibility.tolist() == [2, 2, 2, (1, 0)[number]]
        assert 0.7 < picture.focal_px / (500.0 * 128.0 / (1.25 * 2.0 * spread)) < 1.4
        v, u = np.mgrid[:128, :128]
        for k in range(3):
            near = np.hypot(u - picture.pixels[k, 0], v - picture.pixels[k, 1]) < 8.0
            weights = near * picture.image.astype(float).max(axis=2)
            found = [(weights * each).sum() / weights.sum() for each in (u, v)]
            assert np.abs(found - picture.pixels[k]).max() < 0.1


def test_a_clip_is_a_sequence(repository: Path) -> None:
    """Windows of the shipped clip: where a visible landmark is labelled depends on the window, its pixel does not."""
    clip = repository / "data" / "clips" / "orbit-2.0"
    names = load_target(clip / "target_true.toml").landmarks
    count, found = open_pictures(clip, names, 256, seed=0)
    one, other = (next(each) for each in (found, open_pictures(clip, names, 256, seed=1)[1]))
    assert count == 181
    assert (one.visibility == 2).sum() > 10
    assert not np.allclose(one.pixels, other.pixels)
    assert 1910.0 / one.focal_px == pytest.approx(
        np.ptp(other.pixels[:, 0]) / np.ptp(one.pixels[:, 0]) * 1910.0 / other.focal_px
    )


def test_crops_are_shown_at_the_size_of_the_network(spots: Path) -> None:
    """Half the side: every other centre lies between two, at (p + 1/2) / 2 - 1/2."""
    (count, whole), (_, halved) = (open_pictures(spots, NAMES, size, seed=0) for size in (128, 64))
    assert count > 0
    for one, half in zip(whole, halved, strict=True):
        assert half.image.shape == (64, 64, 3)
        assert np.allclose(half.pixels, 0.5 * one.pixels - 0.25)
        assert half.focal_px == 0.5 * one.focal_px
        means = one.image.reshape(64, 2, 64, 2, 3).mean(axis=(1, 3))
        assert np.abs(half.image - means).max() < 1.5


def test_a_sequence_of_other_landmarks_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="expected the landmarks a, b, c"):
        list(open_pictures(sequence(tmp_path / "flight", 30.0), ("a", "b", "c"), 128, seed=0)[1])


def test_azimuth_is_that_of_the_camera_about_the_target() -> None:
    """The camera stands 30 m to port of the target's middle and looks at it: y axis, 90 degrees."""
    T = np.eye(4)
    T[:3, :3] = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, -1.0, 0.0]]  # right = x, down = -z, forward = -y
    T[:3, 3] = -T[:3, :3] @ [5.0, 30.0, 0.0]
    assert seen_from(T, np.array([5.0, 0.0, 0.0])) == pytest.approx((30.0, 90.0))
    T[:3, 3] *= -1.0
    assert np.isnan(seen_from(T, np.array([5.0, 0.0, 0.0]))).all()


def test_calibrate_writes_what_export_takes(
    spots: Path, trained: Path, tmp_path: Path, repository: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    checkpoint = str(trained / "last.ckpt")
    flight = sequence(tmp_path / "flight", 30.0)
    data = ["--data", str(spots), str(flight), "-o", str(tmp_path / "found")]
    assert main(["calibrate", checkpoint, *data]) == 2
    assert "knows other landmarks than frigate" in capsys.readouterr().err
    told = ["--target", str(flight / "target_true.toml"), "--camera", str(repository / "data/frigate/camera.yaml")]
    assert main(["calibrate", checkpoint, *data, *told]) == 0
    assert "visible landmarks: median" in capsys.readouterr().out
    text = (tmp_path / "found" / "accuracy.md").read_text()
    assert all(f"| {name} | " in text for name in (*NAMES, "crops", "flight"))
    assert (tmp_path / "found" / "reliability.png").is_file()
    told = ["--calibration", str(tmp_path / "found" / "calibration.toml"), "-o", str(tmp_path / "spots.onnx")]
    assert main(["export", checkpoint, *told]) == 0
