# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The truth of a sequence, which needs no renderer: poses, landmarks and whether they are seen.

docs/rendering.md section 3.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from fairlead import geometry
from fairlead.io.bop import BopFrame, Box, write_bop
from fairlead.io.camera import save_camera
from fairlead.io.csv_lines import CsvWriter
from fairlead.io.observations import write_views
from fairlead.io.poses import write_truth
from fairlead.io.target import save_target
from fairlead.render.flights import Placed
from fairlead.render.frame_files import DEPTH_STEP_MM, mask_path, picture_path
from fairlead.render.raycast import RayCaster
from fairlead.types import Camera, Matrix4, Pixels, Target, TruthPose, View

State = Literal["visible", "hidden", "outside"]

SIGMA_PX = 0.05
"""What observations_true.csv claims of itself; it is exact, but a covariance of zero is no covariance."""
COLUMNS = ("frame", "stamp_ns", "landmark", "u_px", "v_px", "depth_m", "state")


@dataclass(frozen=True, kw_only=True, eq=False)
class SeenLandmarks:
    """Every landmark in one image."""

    pixels: Pixels
    """NaN behind the camera."""
    depths: np.ndarray
    """z in camera axes, (n,) [m]."""
    states: tuple[State, ...]


def see(target: Target, camera: Camera, T_camera_target: Matrix4, caster: RayCaster) -> SeenLandmarks:
    """Project and cast a ray to each. Outside: beyond the image, whose edge is half a pixel from the last centre."""
    p = geometry.transform(T_camera_target, target.positions)
    pixels = geometry.project(camera, p)
    size = np.array([camera.width, camera.height])
    with np.errstate(invalid="ignore"):
        beyond = np.maximum(-0.5 - pixels, pixels - (size - 0.5)).max(axis=1)
    centre = -T_camera_target[:3, :3].T @ T_camera_target[:3, 3]
    free = caster.visible(centre, target.positions).tolist()
    states: tuple[State, ...] = tuple(_state(off, seen) for off, seen in zip(beyond.tolist(), free, strict=True))
    return SeenLandmarks(pixels=pixels, depths=p[:, 2], states=states)


def _state(beyond_px: float, free: bool) -> State:  # noqa: FBT001
    """`beyond_px` is NaN for what is behind the camera."""
    if not beyond_px <= 0.0:
        return "outside"
    return "visible" if free else "hidden"


def write_truth_tables(
    folder: Path, target: Target, camera: Camera, placed: Sequence[Placed], caster: RayCaster
) -> None:
    """truth.csv, target_true.toml, camera.yaml, landmarks_true.csv, observations_true.csv."""
    save_camera(folder / "camera.yaml", camera)
    exactly = replace(target, covariance=np.zeros_like(target.covariance), mesh=None)
    save_target(folder / "target_true.toml", exactly)
    write_truth(
        folder / "truth.csv",
        [TruthPose(frame=p.frame, stamp_ns=p.stamp_ns, T_camera_target=p.T_camera_target) for p in placed],
    )
    views: list[View] = []
    with CsvWriter(folder / "landmarks_true.csv", COLUMNS) as writer:
        for p in placed:
            seen = see(target, camera, p.T_camera_target, caster)
            numbers = np.column_stack([seen.pixels, seen.depths]).tolist()
            writer.write_rows(
                [
                    [p.frame, p.stamp_ns, name, *row, state]
                    for name, row, state in zip(target.landmarks, numbers, seen.states, strict=True)
                ]
            )
            views.append(_view(target, p, seen))
    write_views(folder / "observations_true.csv", views)


def write_stamps(folder: Path, placed: Sequence[Placed]) -> None:
    """rgb/stamps.csv."""
    with CsvWriter(folder / "rgb" / "stamps.csv", ("image", "stamp_ns")) as writer:
        writer.write_rows([[picture_path(folder, p.frame).name, p.stamp_ns] for p in placed])


def _view(target: Target, placed: Placed, seen: SeenLandmarks) -> View:
    kept = [k for k, state in enumerate(seen.states) if state == "visible"]
    return View(
        frame=placed.frame,
        stamp_ns=placed.stamp_ns,
        landmarks=tuple(target.landmarks[k] for k in kept),
        pixels=seen.pixels[kept],
        covariances=np.tile(SIGMA_PX**2 * np.eye(2), (len(kept), 1, 1)),
    )


def write_bop_tables(folder: Path, camera: Camera, placed: Sequence[Placed]) -> None:
    """The JSON files of the scene folder; counts and boxes from the masks that were written."""
    from fairlead.opencv import read_image

    frames: list[BopFrame] = []
    for p in placed:
        every, visible = (
            read_image(mask_path(folder, p.frame, visible=choice))[..., 0] > 127 for choice in (False, True)
        )
        frames.append(
            BopFrame(
                frame=p.frame,
                K=camera.K,
                T_camera_target=p.T_camera_target,
                depth_scale=DEPTH_STEP_MM,
                pixels_all=int(every.sum()),
                pixels_visible=int(visible.sum()),
                box_all=box_of(every),
                box_visible=box_of(visible),
            )
        )
    write_bop(folder, frames)


def box_of(mask: np.ndarray) -> Box:
    """The smallest box of whole pixels round a mask."""
    rows, columns = np.nonzero(mask.any(axis=1))[0], np.nonzero(mask.any(axis=0))[0]
    if len(rows) == 0:
        return (-1, -1, -1, -1)
    left, top = int(columns[0]), int(rows[0])
    return (left, top, int(columns[-1]) - left + 1, int(rows[-1]) - top + 1)
