# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What the verbs that make a target are told: annotate and bootstrap."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from fairlead.config import UsageError


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
    """Folder of the frames, or a video or bag whose frames are written to images/ once; else what the folder holds."""
    every: int = 1
    """Of a video or bag take every how many frames."""
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
        if self.every < 1:
            raise UsageError(f"--every: expected a whole number above 0, got {self.every}")
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


TargetConfig = AnnotateConfig | BootstrapConfig
