# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The meeting point before there is a target: folders and photographs to `annotate` and `bootstrap`."""

import shutil
from collections.abc import Callable
from pathlib import Path

from fairlead.annotate.project import JOURNAL, Frame, Project, open_project
from fairlead.annotate.surface import SUFFIXES as MESHES
from fairlead.annotate.surface import Surface, load_surface
from fairlead.bootstrap import BootstrapError, Bootstrapped, bootstrap_landmarks, bootstrap_tags
from fairlead.config import UsageError
from fairlead.detect import detector_from_spec
from fairlead.io.bop import is_bop
from fairlead.io.camera import load_camera
from fairlead.io.csv_lines import CsvWriter
from fairlead.io.errors import InputError
from fairlead.io.observations import read_views
from fairlead.io.target import check_target_name, load_target, save_target
from fairlead.opencv.filters import write_image
from fairlead.sources.bop import BopSource
from fairlead.sources.image_folder import SUFFIXES as IMAGES
from fairlead.sources.image_folder import ImageFolderSource
from fairlead.sources.opening import open_images
from fairlead.target_config import AnnotateConfig, BootstrapConfig
from fairlead.types import Camera, KnownDistance, Target, View

IMAGE_FOLDERS = ("images", "rgb", ".")
DEFAULT_FPS = 1.0
KNOWN_TO = 0.01
"""How well a length is known where nothing is said, as a share of it [-]."""


def annotate(config: AnnotateConfig, tell: Callable[[str], None]) -> None:
    """Serve the page until the process is told to stop; `tell` hears its address.

    Raises InputError or UsageError before anything is changed: no folder, a mesh, camera or target that cannot be used,
    labels of another target, a port that is taken, the extra `annotate` not installed.
    """
    try:
        from fairlead.annotate.page.server import HOST, free_port, serve
    except ModuleNotFoundError as error:
        raise UsageError(
            f"annotate needs the extra of that name ({error.name}): pip install 'fairlead[annotate]'"
        ) from error
    from fairlead.annotate.workbench import Workbench

    try:
        port = free_port(config.port)
    except OSError as error:
        raise UsageError(f"--port: {config.port} is taken: {error.strerror}; expected another, or 0 for any") from error
    project = load_project(config)
    try:
        tell(f"http://{HOST}:{port}")
        serve(Workbench(project), port, show=config.show)
    finally:
        project.journal.close()


def load_project(config: AnnotateConfig) -> Project:
    """Find and open what a folder holds. Raises InputError."""
    folder = config.folder
    if not folder.is_dir():
        raise InputError(folder, "expected a folder with a mesh, or with images and camera.yaml")
    target = _target(config)
    surface = _surface(config, target)
    camera = _camera(config)
    frames = _frames(config, camera)
    if surface is None and not frames and target is None and not (folder / JOURNAL).exists():
        kinds = " ".join(MESHES)
        raise InputError(folder, f"expected a mesh ({kinds}), or camera.yaml and images, or target.toml; found none")
    return open_project(folder, surface=surface, camera=camera, target=target, frames=frames)


def _target(config: AnnotateConfig) -> Target | None:
    path = config.folder / "target.toml" if config.target is None else config.target
    return load_target(path) if config.target is not None or path.exists() else None


def _surface(config: AnnotateConfig, target: Target | None) -> Surface | None:
    path = config.mesh
    if path is None and target is not None:
        path = target.mesh
    if path is None:
        found = sorted(each for each in config.folder.iterdir() if each.suffix.lower() in MESHES)
        if len(found) > 1:
            names = ", ".join(each.name for each in found[:4])
            raise InputError(config.folder, f"holds {len(found)} meshes ({names}): say which with --mesh")
        path = found[0] if found else None
    return None if path is None else load_surface(path, config.mesh_scale)


def _camera(config: AnnotateConfig) -> Camera | None:
    path = config.folder / "camera.yaml" if config.camera is None else config.camera
    return load_camera(path) if config.camera is not None or path.exists() else None


def _frames(config: AnnotateConfig, camera: Camera | None) -> list[Frame]:
    recording = None if config.images is None or config.images.is_dir() else config.images
    folder = config.folder / "images" if recording is not None else _image_folder(config)
    if folder is None:
        return []
    if camera is None:
        raise InputError(config.folder, "holds images and no camera.yaml: expected a calibration there, or --camera")
    if recording is not None and not folder.exists():
        _write_frames(recording, folder, camera, config)
    source = _source(folder, camera, config.fps)
    return [Frame(number=number, stamp_ns=stamp_ns, path=path) for number, stamp_ns, path in source.listed()]


def _source(folder: Path, camera: Camera, fps: float | None) -> BopSource | ImageFolderSource:
    """With stamps as they are, else `fps`."""
    if folder.name == "rgb" and is_bop(folder.parent):
        return BopSource(folder.parent, camera, fps=fps)
    try:
        return ImageFolderSource(folder, camera, fps=fps)
    except InputError as error:
        if fps is not None or "give --fps" not in str(error):
            raise
        return ImageFolderSource(folder, camera, fps=DEFAULT_FPS)


def _write_frames(recording: Path, folder: Path, camera: Camera, config: AnnotateConfig) -> None:
    """The frames of a video or bag as images with their stamps; the folder is there when all of them are."""
    part = folder.with_name(f".{folder.name}.part")
    shutil.rmtree(part, ignore_errors=True)
    part.mkdir()
    with CsvWriter(part / "stamps.csv", ("image", "stamp_ns")) as stamps:
        for each in open_images(recording, camera, fps=config.fps, topic=None):
            if each.frame % config.every == 0:
                write_image(part / f"{each.frame:06d}.png", each.image)
                stamps.write_rows([(f"{each.frame:06d}.png", each.stamp_ns)])
    part.replace(folder)


def _image_folder(config: AnnotateConfig) -> Path | None:
    """Where the frames are. Raises InputError for a folder that was named and is none."""
    if config.images is not None:
        if not config.images.is_dir():
            raise InputError(config.images, "expected a folder of images")
        return config.images
    for name in IMAGE_FOLDERS:
        folder = config.folder / name
        if folder.is_dir() and any(each.suffix.lower() in IMAGES for each in folder.iterdir()):
            return folder
    return None


def bootstrap(config: BootstrapConfig) -> Bootstrapped:
    """Make and write a first target. Raises InputError, UsageError; what was at the output is then left alone."""
    if (config.tag_size_m is None) == (config.distance is None):
        raise UsageError("bootstrap: expected --tag-size-m or --distance A B LENGTH: views do not tell the size")
    lengths = (config.tag_size_m, config.tag_sigma_m, config.distance_sigma_m, (config.distance or (0, 0, None))[2])
    if any(length is not None and not 0.0 < length < 1e6 for length in lengths):
        raise UsageError("bootstrap: expected lengths above 0 m")
    check_target_name(config.output)
    camera = load_camera(config.camera)
    views = _views(config, camera)
    name = config.name or config.output.stem
    try:
        if config.tag_size_m is not None:
            sigma_m = KNOWN_TO * config.tag_size_m if config.tag_sigma_m is None else config.tag_sigma_m
            made = bootstrap_tags(views, camera, config.tag_size_m, sigma_m, name)
        else:
            assert config.distance is not None
            a, b, length_m = config.distance
            sigma_m = KNOWN_TO * length_m if config.distance_sigma_m is None else config.distance_sigma_m
            distance = KnownDistance(between=(a, b), length_m=length_m, sigma_m=sigma_m)
            made = bootstrap_landmarks(views, camera, distance, name)
    except BootstrapError as error:
        raise InputError(config.source, str(error)) from error
    except ValueError as error:
        raise UsageError(f"bootstrap: {error}") from error
    config.output.parent.mkdir(parents=True, exist_ok=True)
    save_target(config.output, made.target)
    return made


def _views(config: BootstrapConfig, camera: Camera) -> list[View]:
    """From a table, or found in photographs, whose stamps do not matter here."""
    if not config.source.is_dir():
        return list(read_views(config.source))
    if config.detector is None:
        raise UsageError(f"{config.source} is a folder of photographs: expected --detector too")
    try:
        detector = detector_from_spec(config.detector, None)
    except ValueError as error:
        raise UsageError(f"--detector: {str(error).removeprefix('detector: ')}") from error
    source = _source(config.source, camera, None)
    return [detector.detect(each.image, each.frame, each.stamp_ns) for each in source]
