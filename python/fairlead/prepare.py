# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The meeting point before there is a target: folders and photographs to `annotate` and `bootstrap`."""

from collections.abc import Callable
from pathlib import Path

from fairlead.annotate.project import JOURNAL, Frame, Project, open_project
from fairlead.annotate.surface import SUFFIXES as MESHES
from fairlead.annotate.surface import Surface, load_surface
from fairlead.config import AnnotateConfig, UsageError
from fairlead.io.bop import is_bop
from fairlead.io.camera import load_camera
from fairlead.io.errors import InputError
from fairlead.io.target import load_target
from fairlead.sources.bop import BopSource
from fairlead.sources.image_folder import SUFFIXES as IMAGES
from fairlead.sources.image_folder import ImageFolderSource
from fairlead.types import Camera, Target

IMAGE_FOLDERS = ("images", "rgb", ".")
DEFAULT_FPS = 1.0


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
    folder = _image_folder(config)
    if folder is None:
        return []
    if camera is None:
        raise InputError(config.folder, "holds images and no camera.yaml: expected a calibration there, or --camera")
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
