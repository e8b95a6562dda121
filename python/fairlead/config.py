# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What each verb is told: frozen types that are the command line, the Python call and the record in run.json."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional, arg

Method = Literal["map", "window", "epnp"]
StudyKind = Literal["noise", "angle", "grid"]
Backend = Literal["threads", "dask"]


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
    range: Path | None = None
    """range.csv: readings of a range finder (method map)."""
    attitude: Path | None = None
    """attitude.csv: the camera's attitude, for the motion kind world (method map)."""


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


@dataclass(frozen=True, kw_only=True)
class RenderConfig:
    """Render a target with a mesh: sequences with exact truth, or crops to train a detector with."""

    sequence: Positional[str]
    """orbit-2.0, rendezvous-10, rendezvous-20, rendezvous-30, landing, crops, or a truth.csv."""
    output: Annotated[Path, arg(aliases=["-o"])]
    """Folder for the images; what is there already is not rendered again."""
    target: Path | None = None
    """target.toml that names a mesh; the frigate if not given."""
    camera: Path | None = None
    """Calibration of a camera without distortion; camera.yaml beside the target if not given."""
    quality: Literal["full", "draft"] | None = None
    """full: Cycles, seconds an image. draft: OpenGL, many a second. Sequences are full, crops draft if not said."""
    samples: int = 16
    """Light paths per pixel at full quality: fewer are grainy, more take longer."""
    surroundings: Literal["sea", "space"] = "sea"
    """What the target is in."""
    weather: Literal["fog", "rain", "snow", "glare", "dusk", "night", "low-contrast"] | None = None
    """Between target and camera; crops draw their own."""
    strength: float = 0.5
    """Of the weather: 0 is clear, 1 as bad as it gets [-]."""
    sun_elevation_deg: float = 35.0
    """Of the sun above the horizon [deg]."""
    wind_m_s: float = 7.5
    """Makes the waves [m/s]."""
    swell: bool = False
    """Let the target heave, roll and pitch."""
    stride: int = 5
    """Every how many frames of the 25 Hz camera one is rendered."""
    frames: int | None = None
    """Only so many, from the first on."""
    depth: bool = False
    """Write depth images, too."""
    reuse: Path | None = None
    """Folder of the same sequence at full quality: its light is developed anew, with other weather."""
    count: int = 1000
    """How many crops."""
    size: int = 256
    """Side of a crop [px]."""
    seed: int = 0
    """Of everything that is drawn by chance."""
    jobs: int = 1
    """Processes."""

    def __post_init__(self) -> None:
        if not (
            0.0 <= self.strength <= 1.0 and 1.0 <= self.wind_m_s <= 30.0 and -1.0 <= self.sun_elevation_deg <= 89.0
        ):
            raise UsageError("render: expected --strength 0 to 1, --wind-m-s 1 to 30, --sun-elevation-deg -1 to 89")
        least = min(self.samples, self.stride, self.count, self.jobs, 1 if self.frames is None else self.frames)
        if least < 1 or not 32 <= self.size <= 2048 or self.seed < 0:
            raise UsageError("render: expected whole numbers above 0, --size 32 to 2048, --seed not below 0")


@dataclass(frozen=True, kw_only=True)
class StudyConfig:
    """Every method on the same simulated flights, many runs a setting: tables and figures. Goes on where it stopped."""

    study: Positional[StudyKind]
    """noise: published figure 7. angle: figure 8. grid: noise x angle x model error x outliers."""
    output: Annotated[Path, arg(aliases=["-o"])]
    """Folder for rows, tables and figures; runs of the same study that are in it count."""
    runs: int = 1000
    """Of each setting."""
    methods: tuple[str, ...] | None = None
    """Only these, e.g. epnp window map bound."""
    only: str = "*"
    """Only the settings whose name matches, e.g. 's1-*'."""
    replay: tuple[str, int] | None = None
    """SETTING RUN: show one run view by view instead; the setting as in the table, e.g. s1-a90-m1-o0-v10 17."""
    backend: Backend = "threads"
    """threads: this machine. dask: a cluster that is there already."""
    scheduler: str | None = None
    """Address of the dask scheduler, e.g. tcp://head:8786."""
    threads: int | None = None
    """Of this machine; all that it has if not given."""
    seed: int = 0
    """Of the study; every run has a seed of its own that follows from it."""
    target: Path | None = None
    """target.toml with the true landmarks instead of the frigate's."""
    camera: Path | None = None
    """Calibration instead of the frigate's camera."""

    def __post_init__(self) -> None:
        for name, value, least in (("runs", self.runs, 1), ("seed", self.seed, 0), ("threads", self.threads, 1)):
            if value is not None and value < least:
                raise UsageError(f"--{name}: expected a whole number >= {least}, got {value}")
        if self.replay is not None and self.replay[1] < 0:
            raise UsageError(f"--replay: expected the number of a run, got {self.replay[1]}")
        if (self.backend == "dask") != (self.scheduler is not None):
            raise UsageError("--backend dask and --scheduler ADDRESS go together")


@dataclass(frozen=True, kw_only=True)
class AnnotateConfig:
    """A page in the browser, of this machine alone: landmarks on a mesh, marks in frames, truth poses."""

    folder: Positional[Path]
    """What is annotated: mesh, camera.yaml, images/ or rgb/, target.toml if there is one; the labels go there, too."""
    mesh: Path | None = None
    """PLY, OBJ, STL or glTF, if there is not just one in the folder."""
    mesh_scale: float = 1.0
    """Metres in a unit of the mesh: 0.001 for one in millimetres."""
    target: Path | None = None
    """Landmarks to begin with; target.toml of the folder if not given."""
    camera: Path | None = None
    """Calibration; camera.yaml of the folder if not given."""
    images: Path | None = None
    """Folder of the frames; images/, rgb/ or the folder itself if not given."""
    fps: float | None = None
    """Frames per second where the images carry no stamps [1/s]; 1 if not given."""
    port: int = 8090
    """Of the page; 0: any that is free."""
    show: bool = True
    """Open the browser."""

    def __post_init__(self) -> None:
        if not 0.0 < self.mesh_scale < 1e9:
            raise UsageError(f"--mesh-scale: expected metres in a unit of the mesh, got {self.mesh_scale}")
        if self.fps is not None and not 0.0 < self.fps < 1e6:
            raise UsageError(f"--fps: expected a positive number of frames per second, got {self.fps}")
        if not 0 <= self.port < 65536:
            raise UsageError(f"--port: expected 0 to 65535, got {self.port}")


@dataclass(frozen=True, kw_only=True)
class BootstrapConfig:
    """A first target where there is none: from a few views of unsurveyed tags, or of marked landmarks."""

    source: Positional[Path]
    """observations.csv or .parquet, or a folder of photographs (then --detector too)."""
    camera: Path
    """Calibration: ROS camera_info, OpenCV or Kalibr YAML, COLMAP cameras.txt."""
    output: Annotated[Path, arg(aliases=["-o"])]
    """target.toml to be written; its covariance goes beside it."""
    detector: str | None = None
    """What finds the tags in photographs, e.g. apriltag:36h11."""
    tag_size_m: float | None = None
    """Side of the black square of every tag [m]."""
    tag_sigma_m: float | None = None
    """How well it is known [m]; a hundredth of it if not given."""
    distance: tuple[str, str, float] | None = None
    """Without tags: two landmarks and how far apart they are [m], e.g. bow stern 140.1."""
    distance_sigma_m: float | None = None
    """How well it is known [m]; a hundredth of it if not given."""
    name: str | None = None
    """Of the target; that of the output file if not given."""


Config = (
    TrackConfig
    | RefineConfig
    | EvaluateConfig
    | SimulateConfig
    | RenderConfig
    | StudyConfig
    | DemoConfig
    | AnnotateConfig
    | BootstrapConfig
)
