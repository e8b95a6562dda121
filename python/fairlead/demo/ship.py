# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""`fairlead demo ship`: from pixels to poses, on a rendered clip whose truth is known.

The clip (data/clips/demo) shows the frigate for 8 s; the landmarks that the tracker is told are each about a metre off
(data/frigate/rough.toml). The shipped network finds them in every image.
"""

import json
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fairlead import run
from fairlead.config import DemoConfig, Method, TrackConfig
from fairlead.evaluate import evaluate_runs
from fairlead.io.shipped import shipped_data
from fairlead.io.timing import read_timing
from fairlead.progress import ProgressFactory, silent

SHOWN: tuple[tuple[str, str], ...] = (
    ("rotation_deg", "rotation, mean [deg]"),
    ("translation_m", "translation, mean [m]"),
    ("translation_percent", "translation, mean [% of range]"),
    ("landmarks_m", "landmarks, rms [m]"),
    ("pose_nees", "NEES of the pose / dof [-]"),
    ("coverage_percent", "frames with a pose [%]"),
)
"""Metrics of docs/metrics.md, and what they are called in the table."""


@dataclass(frozen=True, kw_only=True)
class ShipResult:
    """What the demo shows."""

    report: Path
    overlay: Path
    frames: int
    frames_per_s: float
    """From the coded picture to the pose, median over the clip; drawing the overlay left out [1/s]."""
    metrics: dict[str, dict[str, float]]
    """By method, then by key of SHOWN; what a method does not have is left out."""
    landmarks_told_m: float
    """Error of the model that was told [m]."""
    seconds: float


def demo_ship(config: DemoConfig, progress: ProgressFactory = silent) -> ShipResult:
    """Track the clip with the shipped network, and beside it EPnP on the same keypoints; runs, overlay and report."""
    start_s = time.monotonic()
    clip, told = shipped_data("clips/demo"), shipped_data("frigate") / "rough.toml"
    overlay = config.output / "overlay.mkv"
    config.output.mkdir(parents=True, exist_ok=True)
    pixels = TrackConfig(
        source=clip / "clip.mkv",
        target=told,
        camera=clip / "camera.yaml",
        detector="frigate",
        overlay=overlay,
        truth=clip / "truth.csv",
        output=config.output / "fairlead",
    )
    summary = run.track(pixels, progress)
    keypoints = pixels.output / "observations.csv"
    beside = _beside(keypoints, pixels, config.output / "epnp", "epnp")
    report = evaluate_runs(
        {"epnp": beside, "fairlead": pixels.output},
        pixels.truth,
        target_true=clip / "target_true.toml",
        output=config.output,
    )
    runs = json.loads((report.parent / "metrics.json").read_text(encoding="utf-8"))["runs"]
    frame_ms = [each.read_ms + each.detect_ms + each.update_ms for each in read_timing(pixels.output / "timing.csv")]
    metrics = {name: each["metrics"] for name, each in runs.items()}
    return ShipResult(
        report=report,
        overlay=overlay,
        frames=summary.frames,
        frames_per_s=1e3 / float(np.median(frame_ms)),
        metrics={name: {key: each[key] for key, _ in SHOWN if key in each} for name, each in metrics.items()},
        landmarks_told_m=metrics["fairlead"]["landmarks_before_m"],
        seconds=time.monotonic() - start_s,
    )


def _beside(keypoints: Path, pixels: TrackConfig, output: Path, method: Method) -> Path:
    """Another method on the keypoints that were found."""
    run.track(TrackConfig(source=keypoints, target=pixels.target, camera=pixels.camera, output=output, method=method))
    return output
