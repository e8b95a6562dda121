# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What a codec costs: how far the image about each visible landmark moves when a rendered sequence becomes a clip.

    python -m benchmarks.codec SCENE --crf 22 26 30 --last 50

SCENE is a folder written by `fairlead render`. One line per rate factor, and one for other noise of the sensor where
the scene kept its light. docs/rendering.md section 10.
"""

import argparse
import sys
import tempfile
from collections.abc import Iterator, Sequence
from fractions import Fraction
from pathlib import Path

import numpy as np
from jaxtyping import Float64, UInt8

from fairlead.io.csv_lines import read_csv
from fairlead.opencv import grey, read_image
from fairlead.render.frame_files import linear_path, load_linear, picture_path
from fairlead.render.truth_tables import COLUMNS

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


def visible_landmarks(scene: Path) -> dict[int, list[tuple[float, float]]]:
    """Pixels by frame."""
    found: dict[int, list[tuple[float, float]]] = {}
    for _, cells in read_csv(scene / "landmarks_true.csv", COLUMNS):
        pixels = found.setdefault(int(cells["frame"]), [])
        if cells["state"] == "visible":
            pixels.append((float(cells["u_px"]), float(cells["v_px"])))
    return found


def shifts(before: BgrImage, after: BgrImage, pixels: Sequence[tuple[float, float]]) -> list[np.ndarray]:
    """Of all landmarks whose window lies in the image."""
    first, second = (grey(image).astype(np.float64) for image in (before, after))
    reach, found = RADIUS_PX + 1, []
    for u, v in pixels:
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


def report(name: str, moved: Sequence[np.ndarray]) -> str:
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
    options = parser.parse_args(arguments)
    landmarks = visible_landmarks(options.scene)
    frames = [frame for frame in sorted(landmarks) if picture_path(options.scene, frame).is_file()][-options.last :]
    images = [read_image(picture_path(options.scene, frame)) for frame in frames]
    stamps = [40_000_000 * frame for frame in frames]
    print("| | landmarks | rms of a coordinate [px] | median length | 95 % | largest |\n|---|---|---|---|---|---|")
    if all(linear_path(options.scene, frame).is_file() for frame in frames):
        others = zip(images, noisy(options.scene, frames), frames, strict=True)
        print(report("other noise", [each for a, b, k in others for each in shifts(a, b, landmarks[k])]))
    for crf in options.crf:
        decoded, size = coded(images, stamps, crf)
        pairs = zip(images, decoded, frames, strict=True)
        moved = [each for a, b, k in pairs for each in shifts(a, b, landmarks[k])]
        print(report(f"crf {crf:g}, {size:.0f} kB a picture", moved), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
