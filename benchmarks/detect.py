# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A landmark network on rendered images: errors, honesty of its covariances, acquisition, time per stage.

    python -m benchmarks.detect NETWORK sequence FOLDER ... [--every 1]
    python -m benchmarks.detect NETWORK crops FOLDER [--count 300]

FOLDER is what `fairlead render` wrote: a sequence or a clip, or crops, those without the target being what must not be
found.
Every image of a sequence is followed from the one before it; each crop is searched as a whole image of its own.
"""

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fairlead.detect.network import NetworkDetector
from fairlead.io.camera import load_camera
from fairlead.io.coco import read_coco
from fairlead.io.observations import read_views
from fairlead.io.target import load_target
from fairlead.opencv import read_image
from fairlead.sources.bop import BopSource
from fairlead.sources.video import VideoSource
from fairlead.tracker import Tracker
from fairlead.types import Camera, View

QUANTILES = (0.5, 0.9, 0.99)


@dataclass(frozen=True, kw_only=True)
class Errors:
    """Of landmarks that were reported in one image."""

    px: np.ndarray
    """Distance to the truth in the full image; NaN where the truth is hidden."""
    nees: np.ndarray
    """e^T S^-1 e / 2."""
    seen: int
    """Landmarks that are truly visible."""


def errors(view: View, truth: View) -> Errors:
    """Compare with where the visible landmarks truly are."""
    places = dict(zip(truth.landmarks, truth.pixels, strict=True))
    true = np.array([places.get(name, (np.nan, np.nan)) for name in view.landmarks]).reshape(-1, 2)
    e = view.pixels - true
    S_inverse = np.linalg.inv(view.covariances) if len(e) else np.empty((0, 2, 2))
    nees = 0.5 * np.einsum("ni,nij,nj->n", e, S_inverse, e)
    return Errors(px=np.linalg.norm(e, axis=1), nees=nees, seen=len(truth.landmarks))


class Stopwatch:
    """Processor time of one method, in place of the method; other work on the machine does not count."""

    def __init__(self, owner: object, method: str) -> None:
        self.ms: list[float] = []
        self._call: Callable[..., object] = getattr(owner, method)
        setattr(owner, method, self)

    def __call__(self, *arguments: object) -> object:
        start = time.thread_time()
        result = self._call(*arguments)
        self.ms.append(1e3 * (time.thread_time() - start))
        return result


def sequence(network: Path, folder: Path, every: int) -> None:
    """One rendered flight: landmark errors, and how often the whole image was searched."""
    camera, target = load_camera(folder / "camera.yaml"), load_target(folder / "target_true.toml")
    rough = replace(target, covariance=np.eye(3 * len(target.landmarks)))
    truth = {view.frame: view for view in read_views(folder / "observations_true.csv")}
    detector, tracker = NetworkDetector(network, rough, camera), Tracker(rough, camera)
    stages = {name: Stopwatch(detector.network, name) for name in ("blob", "run", "look")}
    found: list[Errors] = []
    total, empty = [], 0
    clip = folder / "clip.mkv"
    for number, image in enumerate(VideoSource(clip, camera) if clip.is_file() else BopSource(folder, camera)):
        if number % every:
            continue
        start = time.thread_time()
        view = detector.detect(image.image, image.frame, image.stamp_ns)
        total.append(1e3 * (time.thread_time() - start))
        detector.follow(tracker.update(view))
        empty += not view.landmarks
        found.append(errors(view, truth[image.frame]))
    _report(folder.name, found)
    print(f"  {len(found)} images, {empty} with nothing found, {detector.acquisitions} searched as a whole")
    decode = np.median(stages["look"].ms) - np.median(stages["blob"].ms) - np.median(stages["run"].ms)
    rest = np.median(total) - np.median(stages["look"].ms)
    times = f"normalise {np.median(stages['blob'].ms):.2f}, network {np.median(stages['run'].ms):.1f}"
    print(f"  ms, median: {times}, decode {decode:.2f}, crop and agreement {rest:.2f}; image {np.median(total):.1f}")


def _report(name: str, found: list[Errors]) -> None:
    px, nees = (np.concatenate([getattr(each, key) for each in found]) for key in ("px", "nees"))
    visible = np.isfinite(px)
    seen = sum(each.seen for each in found)
    print(f"{name}: {visible.sum()} of {seen} visible landmarks reported, {(~visible).sum()} hidden ones besides")
    if visible.any():
        quantiles = ", ".join(f"{100 * q:g} % {np.quantile(px[visible], q):.2f}" for q in QUANTILES)
        print(f"  error px: mean {px[visible].mean():.2f}, {quantiles}")
        print(f"  NEES: mean {nees[visible].mean():.2f}, median {np.median(nees[visible]):.2f} (0.69 if true)")


def crops(network: Path, folder: Path, target_file: Path, count: int) -> None:
    """Crops as images of their own: found where there is a target, not found where there is none."""
    target = load_target(target_file)
    _, labels = read_coco(folder / "annotations.json")
    tallies = {True: [0, 0], False: [0, 0]}
    for label in labels[:count]:
        present = sum(v == 2 for v in label.visibility) >= 6
        if not present and any(label.visibility):
            continue  # too little of it to ask for
        lens = Camera(
            name="crop", width=label.width, height=label.height, model="pinhole", K=label.K, distortion=np.empty(0)
        )
        view = NetworkDetector(network, target, lens).detect(read_image(folder / label.file_name), 0, 0)
        tallies[present][0] += len(view.landmarks) > 0
        tallies[present][1] += 1
    for present, (found, of) in tallies.items():
        print(f"{folder.name}: found in {found} of {of} images {'with' if present else 'without'} the target")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("network", type=Path)
    parser.add_argument("what", choices=("sequence", "crops"))
    parser.add_argument("folders", type=Path, nargs="+")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--target", type=Path, default=Path("data/frigate/target.toml"))
    options = parser.parse_args()
    for folder in options.folders:
        if options.what == "sequence":
            sequence(options.network, folder, options.every)
        else:
            crops(options.network, folder, options.target, options.count)


if __name__ == "__main__":
    main()
