# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What each verb is told: frozen types that are the command line, the Python call and the record in run.json."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional, arg

from fairlead.sinks.argument import SinkOptions
from fairlead.sources.argument import ImageOptions, Source

Method = Literal["map", "window", "epnp"]
StudyKind = Literal["noise", "angle", "grid"]
Backend = Literal["threads", "dask"]


class UsageError(ValueError):
    """Arguments that do not go together. One line."""


@dataclass(frozen=True, kw_only=True)
class InputConfig(ImageOptions):
    """What track and refine are told alike."""

    source: Positional[Source]
    """observations.csv, .parquet; with --detector images: folder, BOP scene, video, bag, camera:0, rtsp://..."""
    target: Path
    """target.toml: landmarks, and how well they are known."""
    output: Annotated[Path, arg(aliases=["-o"])]
    """Folder for the results; files of an earlier run in it are replaced."""
    truth: Path | None = None
    """truth.csv; the run is then evaluated as well."""
    options: Path | None = None
    """TOML file of estimator options."""
    range: Path | None = None
    """range.csv: readings of a range finder (method map)."""
    attitude: Path | None = None
    """attitude.csv: the camera's attitude, for the motion kind world (method map)."""
    range_bias_sigma_m: float = 0.0
    """What the range finder may always read too much, 1 sigma [m]; above 0 it is estimated (method map)."""
    min_coverage: float = 0.5
    """Exit status 1 if a smaller share of the frames got a pose [-]."""

    def __post_init__(self) -> None:
        if self.fps is not None and not 0.0 < self.fps < 1e6:
            raise UsageError(f"--fps: expected a positive number of frames per second, got {self.fps}")
        if not 0.0 <= self.min_coverage <= 1.0:
            raise UsageError(f"--min-coverage: expected a share between 0 and 1, got {self.min_coverage}")
        if not 0.0 <= self.range_bias_sigma_m < float("inf"):
            raise UsageError(f"--range-bias-sigma-m: expected zero or more metres, got {self.range_bias_sigma_m}")
        if self.range_bias_sigma_m > 0.0 and self.range is None:
            raise UsageError("--range-bias-sigma-m: expected --range too")


@dataclass(frozen=True, kw_only=True)
class TrackConfig(InputConfig, SinkOptions):
    """Track a target through images or a table of observations, frame by frame."""

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
    """What the program does, on recordings that come along: poses, refined model, report."""

    recording: Positional[Literal["ship", "pen"]] = "ship"
    """ship: a rendered clip through the shipped network, with truth. pen: tags in real photographs, a wrong drawing."""
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
    """Render a target with a mesh: sequences with exact truth, or crops to train a detector with; tags: make a mesh."""

    sequence: Positional[str]
    """orbit-2.0, rendezvous-10, -20 or -30, landing, crops, a truth.csv; or tags: the mesh of a bundle of tags."""
    output: Annotated[Path, arg(aliases=["-o"])]
    """Folder for the images; what is there already is not rendered again. Of tags: a .ply file."""
    target: Path | None = None
    """target.toml that names a mesh; the frigate if not given."""
    camera: Path | None = None
    """Calibration of a camera without distortion; camera.yaml beside the target if not given."""
    quality: Literal["full", "draft"] | None = None
    """full: Cycles, seconds an image. draft: OpenGL, many a second. Sequences are full, crops draft if not said."""
    samples: int = 16
    """Light paths per pixel at full quality: fewer are grainy, more take longer."""
    surroundings: Literal["sea", "space", "room"] = "sea"
    """What the target is in. room: crops alone; they are seen from near, among things that lie about."""
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)
    """Direction in target axes that is up as the target is usually held; for crops."""
    dictionary: str | None = None
    """Family of the tags, as OpenCV spells it (DICT_4X4_100); for tags."""
    quiet: float = 1.0
    """White margin of the tags [cells]; for tags."""
    handle: tuple[float, float, float] | None = None
    """End of a rod from the middle of the bundle, if it has one [m]; for tags."""
    weather: Literal["fog", "rain", "snow", "glare", "dusk", "night", "low-contrast"] | None = None
    """Between target and camera; crops draw their own (--weathered)."""
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
    first: int = 0
    """Number of the frame of that camera to begin with."""
    frames: int | None = None
    """Only so many, from the first on."""
    depth: bool = False
    """Write depth images, too."""
    reuse: Path | None = None
    """Folder of the same sequence at full quality: its light is developed anew, with other weather."""
    clip: Path | None = None
    """Folder for the sequence as a video with its truth."""
    crf: float = 24.0
    """Constant rate factor of that video: less is better and larger."""
    count: int = 1000
    """How many crops."""
    empty: float = 0.0
    """Share of the crops without the target, often with another ship in its place [-]."""
    weathered: float = 0.35
    """Share of the crops in weather of any kind and strength; at sea [-]."""
    size: int = 256
    """Side of a crop [px]."""
    seed: int = 0
    """Of everything that is drawn by chance."""
    jobs: int = 1
    """Processes."""
    threads: int | None = None
    """Of each process at full quality; as many as there are cores if not given."""

    def __post_init__(self) -> None:
        if not (
            0.0 <= self.strength <= 1.0 and 1.0 <= self.wind_m_s <= 30.0 and -1.0 <= self.sun_elevation_deg <= 89.0
        ):
            raise UsageError("render: expected --strength 0 to 1, --wind-m-s 1 to 30, --sun-elevation-deg -1 to 89")
        counts = (self.samples, self.stride, self.count, self.jobs, self.frames, self.threads)
        least = min(count for count in counts if count is not None)
        if not (0.0 <= self.crf <= 51.0 and 0.0 <= self.empty <= 1.0 and 0.0 <= self.weathered <= 1.0):
            got = f"{self.crf}, {self.empty}, {self.weathered}"
            raise UsageError(f"render: expected --crf 0 to 51, --empty and --weathered 0 to 1, got {got}")
        if least < 1 or not 32 <= self.size <= 2048 or min(self.seed, self.first) < 0:
            raise UsageError("render: expected whole numbers above 0, --size 32 to 2048, --seed, --first not below 0")


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
class ReproduceConfig:
    """Every table and figure of the published experiments, theirs beside ours. Goes on where it stopped."""

    output: Annotated[Path, arg(aliases=["-o"])]
    """Folder for the report, tables and figures; sections that are in it stay until they are made again."""
    quick: bool = False
    """3 told models a sequence instead of 20, 50 simulated runs a setting instead of 1000."""
    only: tuple[str, ...] = ()
    """Only these sections, e.g. landmarks poses model times noise angle failures real."""
    sequences: tuple[Path, ...] = ()
    """Folders of sequences with truth.csv, or such sequences; the four flights that come along if not given."""
    networks: tuple[Path, ...] = ()
    """ONNX detectors; those that come along if not given."""
    real: Path | None = None
    """Folder with the recordings marker_pen and temple_ring."""
    weather: Path | None = None
    """Folder with one sequence per weather, named KIND-STRENGTH, e.g. fog-0.4; an empty one is filled by rendering."""
    seeds: int | None = None
    """Told models a sequence."""
    study_runs: int | None = None
    """Simulated runs a setting."""
    target: Path | None = None
    """target.toml of sequences that have none of their own; the frigate's if not given."""
    cache: Path | None = None
    """Folder for detections and runs, which can be made again; cache in the output if not given."""

    def __post_init__(self) -> None:
        for name, value in (("seeds", self.seeds), ("study-runs", self.study_runs)):
            if value is not None and value < 1:
                raise UsageError(f"--{name}: expected a whole number >= 1, got {value}")


_Runs = ReproduceConfig | TrackConfig | RefineConfig | EvaluateConfig | DemoConfig
Config = _Runs | SimulateConfig | RenderConfig | StudyConfig
