# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What `fairlead train`, `calibrate` and `export` do with their arguments. torch is imported when one of them runs."""

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

from fairlead.io.camera import load_camera
from fairlead.io.errors import InputError
from fairlead.io.shipped import shipped_data
from fairlead.io.target import load_target
from fairlead.progress import ProgressFactory, silent


class TrainingError(RuntimeError):
    """Arguments that will not do, or what trains is not installed. One line."""


def train(
    data: Sequence[Path],
    output: Path,
    *,
    target: Path | None = None,
    network: str = "heat-t",
    start: Path | None = None,
    valid: Sequence[Path] = (),
    crops: int = 100_000,
    batch: int = 32,
    rate: float = 1e-3,
    size: int = 256,
    threads: int | None = None,
    workers: int = 1,
    precision: str = "auto",
    settle: int = 8192,
    seed: int = 0,
    progress: ProgressFactory = silent,
) -> list[str]:
    """Train; returns lines for people. Raises InputError, TrainingError."""
    if min(crops, batch, threads or 1) < 1 or min(workers, settle, seed) < 0:
        raise TrainingError("train: expected whole numbers above 0, --workers, --settle and --seed not below 0")
    if not 0.0 < rate < 1.0 or size % 128 or not 128 <= size <= 1024:
        raise TrainingError("train: expected --rate between 0 and 1, --size a multiple of 128 from 128 to 1024")
    _needs_torch()
    from fairlead.train.course import Course, follow
    from fairlead.train.crops import open_crops

    learned, held_out = open_crops(data, valid, size=size, seed=seed)
    if target is not None and load_target(target).landmarks != learned.landmarks:
        raise InputError(target, f"expected the landmarks of {data[0]}: {', '.join(learned.landmarks)}")
    course = Course(
        network=network, output=output, crops=crops, batch=batch, rate=rate, size=size, threads=threads,
        workers=workers, seed=seed, start=start, precision=precision, settle=settle,
    )  # fmt: skip
    return follow(course, learned, held_out, progress=progress)


def calibrate(
    checkpoint: Path,
    data: Sequence[Path],
    output: Path,
    *,
    target: Path | None = None,
    camera: Path | None = None,
    seed: int = 0,
    progress: ProgressFactory = silent,
) -> list[str]:
    """Measure on held-out images; returns lines for people. Raises InputError, TrainingError."""
    _needs_torch()
    from fairlead.train.calibrate import calibrate_network

    folder = shipped_data("frigate") if target is None else target.parent
    told = load_target(folder / "target.toml" if target is None else target)
    lens = load_camera(folder / "camera.yaml" if camera is None else camera)
    return calibrate_network(
        checkpoint, data, output, focal_px=float(lens.K[0, 0]),
        target=told, seed=seed, progress=progress,
    )  # fmt: skip


def export(
    checkpoint: Path,
    output: Path,
    *,
    calibration: Path | None = None,
    target: str = "",
    min_score: float = 0.5,
    progress: ProgressFactory = silent,
) -> list[str]:
    """Write the .onnx file; returns lines for people. Raises InputError, TrainingError."""
    del progress
    if not 0.0 <= min_score <= 1.0:
        raise TrainingError(f"export: expected --min-score from 0 to 1, got {min_score:g}")
    _needs_torch()
    from fairlead.train.export import export_network

    digest = export_network(checkpoint, output, calibration=calibration, target=target, min_score=min_score)
    return [f"{output}: {output.stat().st_size / 1e6:.1f} MB, sha256 {digest}"]


def _needs_torch() -> None:
    try:
        for name in ("torch", "lightning", "onnx"):
            import_module(name)
    except ImportError as error:
        raise TrainingError(f"{error.name} is not installed: pip install 'fairlead[train]'") from error
