# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The grid: its cells, the flights of a cell, and the scores of every method, one file per cell and method."""

import os
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product
from pathlib import Path

import numpy as np

from benchmarks.methods import answer
from benchmarks.scoring import score
from fairlead.io.camera import load_camera
from fairlead.io.target import load_target
from fairlead.simulate import ArcScenario, ModelError, ObservationError, Simulation, simulate_arc
from fairlead.types import Camera, Target
from reference.bound import bayesian_bound
from reference.cameras import make_projection

SIGMAS_PX = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
ANGLES_DEG = (5.0, 10.0, 30.0, 60.0, 90.0, 180.0)
MODEL_SIGMAS_M = (0.1, 0.5, 1.0, 3.0)
OUTLIERS = {"clean": 0.0, "outliers-10": 0.1, "outliers-30": 0.3}
"""Share of observations that are 30 px off, per data set."""

FRIGATE = Path(__file__).resolve().parents[1] / "data" / "frigate"
SEED = 8_110_626


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One setting of the grid."""

    sigma_px: float
    angle_deg: float
    model_sigma_m: float

    @property
    def name(self) -> str:
        """Such as s1-a90-m0.5."""
        return f"s{self.sigma_px:g}-a{self.angle_deg:g}-m{self.model_sigma_m:g}"


def all_cells() -> list[Cell]:
    """The 144 cells."""
    return [
        Cell(sigma_px=s, angle_deg=a, model_sigma_m=m) for s, a, m in product(SIGMAS_PX, ANGLES_DEG, MODEL_SIGMAS_M)
    ]


@lru_cache
def frigate() -> tuple[Target, Camera]:
    """The ship, and the camera without its zero distortion."""
    camera = load_camera(FRIGATE / "camera.yaml")
    if np.any(camera.distortion):
        raise RuntimeError("the study's camera was expected to have no distortion")
    return load_target(FRIGATE / "target.toml"), replace(camera, model="pinhole", distortion=np.zeros(0))


def flights(cell: Cell, data: str, runs: range) -> Iterator[Simulation]:
    """The same flights for every method; own seeds for every cell. Outliers come on top of the same noise."""
    target, camera = frigate()
    scenario = ArcScenario(
        angle_deg=cell.angle_deg,
        model=ModelError(sigma_m=cell.model_sigma_m),
        observation=ObservationError(sigma_px=cell.sigma_px, outlier_fraction=OUTLIERS[data]),
    )
    key = [round(100 * v) for v in (cell.sigma_px, cell.angle_deg, cell.model_sigma_m)]
    for run in runs:
        yield simulate_arc(target, camera, scenario, np.random.default_rng([SEED, *key, run]))


def _bound_row(cell: Cell, flight: Simulation) -> dict[str, np.ndarray]:
    camera, target = flight.camera, flight.target_told
    bound = bayesian_bound(
        make_projection(camera.model, camera.K, camera.distortion),
        flight.X_true, target.covariance, flight.T_true, cell.sigma_px**2 * np.eye(2),
    )  # fmt: skip
    return {
        "rotation_deg": np.degrees(np.sqrt(bound.rotation_variances)),
        "translation_m": np.sqrt(bound.translation_variances),
        "landmark_m": np.array([np.sqrt(bound.landmark_variance)]),
    }


def _method_row(name: str, flight: Simulation) -> dict[str, np.ndarray]:
    start = time.perf_counter()
    found = answer(name, flight)
    seconds = time.perf_counter() - start
    scores = score(found, flight.T_true, flight.X_true)
    return {
        "rotation_deg": scores.rotation_deg,
        "translation_m": scores.translation_m,
        "landmark_m": scores.landmark_m,
        "pose_nees": scores.pose_nees,
        "landmark_nees": np.array([scores.landmark_nees]),
        "seconds": np.array([seconds]),
    }


def run_cell(cell: Cell, data: str, runs: int, names: list[str]) -> dict[str, dict[str, np.ndarray]]:
    """Scores of these methods ("bound" is one of them): arrays (runs, views or landmarks or 1).

    The bound depends on the truth alone, which all flights of a cell share.
    """
    rows: dict[str, list[dict[str, np.ndarray]]] = {name: [] for name in names}
    for flight in flights(cell, data, range(runs)):
        for name in names:
            if name == "bound":
                rows[name].append(rows[name][0] if rows[name] else _bound_row(cell, flight))
            else:
                rows[name].append(_method_row(name, flight))
    return {name: {key: np.stack([row[key] for row in rows[name]]) for key in rows[name][0]} for name in names}


def file_of(folder: Path, cell: Cell, data: str, name: str) -> Path:
    """Where the scores of one method on one cell are kept."""
    return folder / "cells" / data / cell.name / f"{name}.npz"


def load_scores(path: Path, runs: int) -> dict[str, np.ndarray] | None:
    """Scores of the first `runs` runs; None if the file is absent or holds fewer."""
    if not path.exists():
        return None
    with np.load(path, allow_pickle=False) as archive:
        scores = {key: archive[key] for key in archive.files}
    return {key: value[:runs] for key, value in scores.items()} if len(scores["rotation_deg"]) >= runs else None


def complete_cell(folder: Path, cell: Cell, data: str, runs: int, names: list[str]) -> list[str]:
    """Run what is missing; each file appears whole or not at all. Returns the methods that were run."""
    missing = [name for name in names if load_scores(file_of(folder, cell, data, name), runs) is None]
    for name, scores in (run_cell(cell, data, runs, missing) if missing else {}).items():
        path = file_of(folder, cell, data, name)
        path.parent.mkdir(parents=True, exist_ok=True)
        partial = path.with_suffix(f".{os.getpid()}.partial")
        with partial.open("wb") as stream:
            np.savez_compressed(stream, **{key: value.astype(np.float32) for key, value in scores.items()})
        partial.replace(path)
    return missing
