# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What each verb is told: frozen types that are the command line, the Python call and the record in run.json."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional, arg

Method = Literal["map", "window", "epnp"]


class UsageError(ValueError):
    """Arguments that do not go together. One line."""


@dataclass(frozen=True, kw_only=True)
class InputConfig:
    """What track and refine are told alike."""

    source: Positional[Path]
    """observations.csv, observations.parquet, or a folder of images (then --detector too)."""
    target: Path
    """target.toml: landmarks, and how well they are known."""
    camera: Path
    """Calibration: ROS camera_info, OpenCV or Kalibr YAML, COLMAP cameras.txt."""
    output: Annotated[Path, arg(aliases=["-o"])]
    """Folder for the results; files of an earlier run in it are replaced."""
    detector: str | None = None
    """What finds the landmarks in images, e.g. aruco:DICT_4X4_100 or apriltag:36h11."""
    truth: Path | None = None
    """truth.csv; the run is then evaluated as well."""
    options: Path | None = None
    """TOML file of estimator options."""
    fps: float | None = None
    """Frames per second of an image folder without stamps [1/s]."""
    camera_name: str | None = None
    """Which camera of a file that holds several."""
    min_coverage: float = 0.5
    """Exit status 1 if a smaller share of the frames got a pose [-]."""

    def __post_init__(self) -> None:
        if self.fps is not None and not 0.0 < self.fps < 1e6:
            raise UsageError(f"--fps: expected a positive number of frames per second, got {self.fps}")
        if not 0.0 <= self.min_coverage <= 1.0:
            raise UsageError(f"--min-coverage: expected a share between 0 and 1, got {self.min_coverage}")


@dataclass(frozen=True, kw_only=True)
class TrackConfig(InputConfig):
    """Track a target through a table of observations or a folder of images, frame by frame."""

    method: Method = "map"
    """map: this project's estimator. window: the published one. epnp: each frame alone."""


@dataclass(frozen=True, kw_only=True)
class RefineConfig(InputConfig):
    """Refine landmarks and poses of a whole flight in one batch."""


@dataclass(frozen=True, kw_only=True)
class EvaluateConfig:
    """Compare a run with the truth: metrics, figures and one self-contained HTML report."""

    run: Positional[Path]
    """Folder written by track or refine."""
    truth: Path | None = None
    """truth.csv: frame, stamp_ns and the true pose; without it the report says what the observations tell."""
    target_true: Path | None = None
    """target.toml with the true landmarks."""
    output: Annotated[Path | None, arg(aliases=["-o"])] = None
    """Folder for metrics.json and report.html; the run's own if not given."""


@dataclass(frozen=True, kw_only=True)
class DemoConfig:
    """Real photographs of a pen with eight tags whose drawing is wrong: poses, refined model, report."""

    output: Annotated[Path, arg(aliases=["-o"])] = Path("fairlead_demo")
    """Folder for the results."""


@dataclass(frozen=True, kw_only=True)
class SimulateConfig:
    """Draw a flight: what an estimator is told, and apart from it the truth."""

    scenario: Positional[str]
    """scenario.toml, or the name of one that comes along: arc, flight-30s, rolling-ship-5, landing, rough, ..."""
    output: Annotated[Path, arg(aliases=["-o"])]
    """Folder for the files; those of an earlier flight in it are replaced."""
    seed: int | None = None
    """Instead of the scenario's: another flight of the same kind."""
    target: Path | None = None
    """target.toml instead of the scenario's."""
    camera: Path | None = None
    """Calibration instead of the scenario's."""

    def __post_init__(self) -> None:
        if self.seed is not None and self.seed < 0:
            raise UsageError(f"--seed: expected a whole number >= 0, got {self.seed}")


Config = TrackConfig | RefineConfig | EvaluateConfig | SimulateConfig | DemoConfig
