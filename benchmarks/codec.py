# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What a codec costs: how far the image about each visible landmark moves when a rendered sequence becomes a clip.

    python -m benchmarks.codec SCENE --crf 22 26 30 --last 50 [--network frigate.onnx]

SCENE is a folder written by `fairlead render`. One line per rate factor, and one for other noise of the sensor where
the scene kept its light. With a network, also how far its keypoints move, and how wrong they are.
docs/rendering.md section 10.
"""

import argparse
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float64, UInt8

from fairlead.detect.onnx import Network
from fairlead.detect.window import window_about
from fairlead.io.csv_lines import read_csv
from fairlead.opencv import grey, read_image
from fairlead.render.frame_files import linear_path, load_linear, picture_path
from fairlead.render.truth_tables import COLUMNS
from fairlead.types import Pixels

RADIUS_PX, SIGMA_PX = 10, 4.0
"""Of the window about a landmark: half its side, and of its Gaussian weight."""

Patch = Float64[np.ndarray, "side side"]
BgrImage = UInt8[np.ndarray, "h w 3"]


def shift(before: Patch, after: Patch, centre: tuple[float, float]) -> Float64[np.ndarray, "2"]:
    """The displacement (x, y) [px] that explains the difference best, docs/rendering.md eq. (9).

    Both patches have one pixel more on every side than the window; `centre` is the landmark in the window's own pixels.
    """
    gx, gy = 0.5 * (before[1:-1, 2:] - before[1:-1, :-2]), 0.5 * (before[2:, 1:-1] - before[:-2, 1:-1])
    y, x = np.mgrid[: gx.shape[0], : gx.shape[1]]
    weight = np.exp(-0.5 * ((x - centre[0]) ** 2 + (y - centre[1]) ** 2) / SIGMA_PX**2)
    J = np.stack([-gx.ravel(), -gy.ravel(), np.ones(gx.size)], axis=1)  # the last: another brightness is no motion
    weighted = weight.ravel()[:, None] * J
    difference = (after - before)[1:-1, 1:-1].ravel()
    return np.linalg.solve(J.T @ weighted + 1e-9 * np.eye(3), weighted.T @ difference)[:2]


@dataclass(frozen=True, kw_only=True, eq=False)
class Landmarks:
    """The true ones of one picture."""

    names: tuple[str, ...]
    pixels: Pixels
    visible: Bool[np.ndarray, "n"]


def true_landmarks(scene: Path) -> dict[int, Landmarks]:
    """By frame."""
    rows: dict[int, list[tuple[str, float, float, bool]]] = {}
    for _, cells in read_csv(scene / "landmarks_true.csv", COLUMNS):
        row = (cells["landmark"], float(cells["u_px"]), float(cells["v_px"]), cells["state"] == "visible")
        rows.setdefault(int(cells["frame"]), []).append(row)
    return {
        frame: Landmarks(
            names=tuple(name for name, *_ in found),
            pixels=np.array([[u, v] for _, u, v, _ in found]),
            visible=np.array([seen for *_, seen in found]),
        )
        for frame, found in rows.items()
    }


def shifts(before: BgrImage, after: BgrImage, landmarks: Landmarks) -> list[np.ndarray]:
    """Of all visible landmarks whose window lies in the image."""
    first, second = (grey(image).astype(np.float64) for image in (before, after))
    reach, found = RADIUS_PX + 1, []
    for u, v in landmarks.pixels[landmarks.visible].tolist():
        x, y = round(u), round(v)
        if min(x, y) >= reach and x + reach < first.shape[1] and y + reach < first.shape[0]:
            window = np.s_[y - reach : y + reach + 1, x - reach : x + reach + 1]
            found.append(shift(first[window], second[window], (u - x + RADIUS_PX, v - y + RADIUS_PX)))
    return found


def coded(images: Sequence[BgrImage], stamps: Sequence[int], crf: float) -> tuple[list[BgrImage], float]:
    """Written and read back; and kB a picture."""
    import av

    from fairlead.video.clip import ClipWriter

    height, width = images[0].shape[:2]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "clip.mkv"
        rate = Fraction(10**9, stamps[1] - stamps[0])
        with ClipWriter(path, width, height, rate_hz=rate, crf=crf) as writer:
            for image, stamp in zip(images, stamps, strict=True):
                writer.write(image, stamp)
        with av.open(str(path)) as container:
            decoded = [frame.to_ndarray(format="bgr24") for frame in container.decode(video=0)]
        return decoded, path.stat().st_size / 1e3 / len(images)


def noisy(scene: Path, frames: Sequence[int]) -> Iterator[BgrImage]:
    """The light that the scene kept, seen by the same sensor another time; sequences in the default setting only."""
    from fairlead.io.camera import load_camera
    from fairlead.io.shipped import shipped_data
    from fairlead.io.target import load_target
    from fairlead.render.job import Job
    from fairlead.render.sensor import Sensor, develop, exposure_for

    target = load_target(shipped_data("frigate") / "target.toml")
    job = Job(target=target, camera=load_camera(scene / "camera.yaml"), placed=(), folder=scene)
    sensor = Sensor(exposure=exposure_for(job.surrounded(job.surface()).sky.level_irradiance))
    for frame in frames:
        kept = load_linear(scene, frame)
        assert kept is not None
        yield np.ascontiguousarray(develop(kept[0].radiance, sensor, np.random.default_rng([1, frame, 3]))[..., ::-1])


def keypoints(network: Network, image: BgrImage, landmarks: Landmarks) -> Pixels:
    """Where the network finds the visible landmarks, in the square that a tracker would show it."""
    low, high = landmarks.pixels.min(axis=0), landmarks.pixels.max(axis=0)
    side = network.card.input.pad * float((high - low).max())
    window = window_about(0.5 * (low + high), side, network.size)
    found = network.look(window.cut(image)).in_image(window).pixels
    names = [name for name, seen in zip(landmarks.names, landmarks.visible, strict=True) if seen]
    return found[[network.card.landmarks.index(name) for name in names]]


def found_in(network: Network, images: Sequence[BgrImage], shown: Sequence[Landmarks]) -> Pixels:
    """The keypoints of all pictures, one after another."""
    return np.concatenate([keypoints(network, image, truth) for image, truth in zip(images, shown, strict=True)])


def report(name: str, moved: Sequence[np.ndarray] | Pixels) -> str:
    """One line of the table."""
    lengths = np.linalg.norm(moved, axis=1)
    rms = float(np.sqrt(np.mean(np.square(moved))))
    quantiles = f"{np.median(lengths):.3f} | {np.quantile(lengths, 0.95):.3f} | {lengths.max():.2f}"
    return f"| {name} | {len(moved)} | {rms:.3f} | {quantiles} |"


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", type=Path)
    parser.add_argument("--crf", type=float, nargs="+", default=[22.0, 26.0, 30.0])
    parser.add_argument("--last", type=int, default=50, help="so many frames, the last of the scene")
    parser.add_argument("--network", type=Path, help="ONNX file of a landmark network")
    options = parser.parse_args(arguments)
    landmarks = true_landmarks(options.scene)
    frames = [frame for frame in sorted(landmarks) if picture_path(options.scene, frame).is_file()][-options.last :]
    images = [read_image(picture_path(options.scene, frame)) for frame in frames]
    stamps = [40_000_000 * frame for frame in frames]
    shown = [landmarks[frame] for frame in frames]
    network = None if options.network is None else Network(options.network)
    exact = np.concatenate([each.pixels[each.visible] for each in shown])
    original = None if network is None else found_in(network, images, shown)
    print("| | landmarks | rms of a coordinate [px] | median length | 95 % | largest |\n|---|---|---|---|---|---|")
    if all(linear_path(options.scene, frame).is_file() for frame in frames):
        others = zip(images, noisy(options.scene, frames), shown, strict=True)
        print(report("other noise", [each for a, b, truth in others for each in shifts(a, b, truth)]))
    if original is not None:
        print(report("error of the keypoints", original - exact))
    for crf in options.crf:
        decoded, size = coded(images, stamps, crf)
        pairs = zip(images, decoded, shown, strict=True)
        moved = [each for a, b, truth in pairs for each in shifts(a, b, truth)]
        print(report(f"crf {crf:g}, {size:.0f} kB a picture", moved), flush=True)
        if network is not None and original is not None:
            found = found_in(network, decoded, shown)
            print(report(f"crf {crf:g}: keypoints move by", found - original))
            print(report(f"crf {crf:g}: error of the keypoints", found - exact), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
