# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""`fairlead demo ship`: from pixels to poses, on a rendered clip whose truth is known.

The clip (data/clips/demo) shows the frigate for 8 s; the landmarks that the tracker is told are each about a metre off
(data/frigate/rough.toml). The shipped network finds them in every image. How far off a told model happens to be decides
who wins on a single one; so both methods then get the same keypoints with DRAWS more of them, and the means are shown.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

import numpy as np

from fairlead import run
from fairlead.baselines.epnp import EpnpTracker
from fairlead.config import DemoConfig, TrackConfig
from fairlead.evaluate import evaluate, evaluate_runs, metric_values
from fairlead.io.camera import load_camera
from fairlead.io.observations import read_views
from fairlead.io.poses import read_truth
from fairlead.io.run_record import read_run_record
from fairlead.io.shipped import shipped_data
from fairlead.io.target import load_target
from fairlead.io.timing import read_timing
from fairlead.progress import ProgressFactory, silent
from fairlead.tracker import Tracker, TrackerOptions
from fairlead.types import PoseEstimator, Target
from fairlead.video.clip import CLIP

DRAWS = 12

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
    """By method, then by key of SHOWN: means over DRAWS told models."""
    landmarks_told_m: float
    """Error of the models that were told, mean [m]."""
    seconds: float


def demo_ship(config: DemoConfig, progress: ProgressFactory = silent) -> ShipResult:
    """Track the clip with the shipped network, and beside it EPnP on the same keypoints; runs, overlay and report."""
    start_s = time.monotonic()
    clip, told = shipped_data("clips/demo"), shipped_data("frigate") / "rough.toml"
    overlay = config.output / "overlay.mkv"
    config.output.mkdir(parents=True, exist_ok=True)
    pixels = TrackConfig(
        source=clip / CLIP,
        target=told,
        camera=clip / "camera.yaml",
        detector="frigate",
        overlay=overlay,
        truth=clip / "truth.csv",
        output=config.output / "fairlead",
    )
    summary = run.track(pixels, progress)
    keypoints = pixels.output / "observations.csv"
    alone = replace(
        pixels, source=keypoints, detector=None, overlay=None, truth=None, method="epnp", output=config.output / "epnp"
    )
    run.track(alone)
    report = evaluate_runs(
        {"fairlead": pixels.output, "epnp": alone.output},
        pixels.truth,
        target_true=clip / "target_true.toml",
        output=config.output,
    )
    frame_ms = [each.read_ms + each.detect_ms + each.update_ms for each in read_timing(pixels.output / "timing.csv")]
    metrics = _over_draws(clip, pixels.output, progress)
    _write_table(config.output / "demo.csv", metrics)
    return ShipResult(
        report=report,
        overlay=overlay,
        frames=summary.frames,
        frames_per_s=1e3 / float(np.median(frame_ms)),
        metrics={name: {key: each[key] for key, _ in SHOWN} for name, each in metrics.items()},
        landmarks_told_m=metrics["fairlead"]["landmarks_before_m"],
        seconds=time.monotonic() - start_s,
    )


def _write_table(path: Path, metrics: dict[str, dict[str, float]]) -> None:
    """One line a metric, one column a method."""
    keys = ["landmarks_before_m", *(key for key, _ in SHOWN)]
    lines = [
        ",".join(["metric", *metrics]),
        *(",".join([key, *(f"{m[key]:.6g}" for m in metrics.values())]) for key in keys),
    ]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _over_draws(clip: Path, tracked: Path, progress: ProgressFactory) -> dict[str, dict[str, float]]:
    """Means of the metrics of both methods over told models X0 ~ N(X, P0), the same for both."""
    true, camera = load_target(clip / "target_true.toml"), load_camera(clip / "camera.yaml")
    truth, views = read_truth(clip / "truth.csv"), list(read_views(tracked / "observations.csv"))
    prior = load_target(tracked / "target.toml")
    options = TrackerOptions(**cast(dict[str, Any], read_run_record(tracked / "run.json").estimator))
    makers: dict[str, Callable[[Target], PoseEstimator]] = {
        "epnp": lambda told: EpnpTracker(told, camera),
        "fairlead": lambda told: Tracker(told, camera, options),
    }
    found: dict[str, list[dict[str, float]]] = {name: [] for name in makers}
    with progress("other told models", lambda: DRAWS) as advance:
        for seed in range(DRAWS):
            drawn = np.random.default_rng(seed).multivariate_normal(true.positions.ravel(), prior.covariance)
            told = replace(prior, positions=drawn.reshape(-1, 3))
            for name, make in makers.items():
                estimator = make(told)
                estimates = [estimator.update(view) for view in views]
                refined = estimator.model if name == "fairlead" else told
                judged = evaluate(truth, estimates, target0=told, target_estimated=refined, target_true=true)
                found[name].append(dict(metric_values(judged)))
            advance(1)
    return {name: {key: float(np.mean([one[key] for one in rows])) for key in rows[0]} for name, rows in found.items()}
