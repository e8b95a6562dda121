# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A small drawn clip: a book of four tags, half open, before a moving camera, with exact truth."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from fairlead import opencv
from fairlead.cameras import project
from fairlead.geometry import exp_se3, exp_so3, transform
from fairlead.io.bop import BopFrame, write_bop
from fairlead.io.camera import save_camera
from fairlead.io.poses import write_truth
from fairlead.types import Camera, TruthPose

DICTIONARY = "DICT_4X4_50"
DETECTOR = f"aruco:{DICTIONARY}"
PERIOD_NS = 100_000_000
SIDE_M = 0.08
FRAMES = 40
K = np.array([[420.0, 0.0, 159.5], [0.0, 420.0, 119.5], [0.0, 0.0, 1.0]])
CAMERA = Camera(name="drawn", width=320, height=240, model="plumb_bob", K=K, distortion=np.zeros(5))

Edit = Callable[[int, np.ndarray], np.ndarray]
"""Number of the frame, image -> image."""


def tag_corners() -> dict[int, np.ndarray]:
    """Corners tl, tr, br, bl of each tag in the target frame [m]: two pages of two, 100 degrees apart."""
    square = 0.5 * SIDE_M * np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
    corners = {}
    for page, turn in enumerate((0.7, -0.7)):
        R = exp_so3(np.array([0.0, turn, 0.0]))
        for row in range(2):
            middle = np.array([(1 if page else -1) * 0.06, 0.1 * (row - 0.5), 0.0])
            corners[2 * page + row] = (square + middle) @ R.T
    return corners


def true_pose(frame: float) -> np.ndarray:
    """T_camera_target: 0.75 m away, coming nearer, swaying."""
    sway = 0.25 * np.sin(0.12 * frame)
    return exp_se3(np.array([0.02 * np.sin(0.2 * frame), 0.01, 0.75 - 0.003 * frame, 0.0, 0.0, 0.0])) @ exp_se3(
        np.array([0.0, 0.0, 0.0, 0.15 * np.cos(0.1 * frame), sway, 0.05])
    )


def draw(T_camera_target: np.ndarray) -> np.ndarray:
    """The tags on a grey ground, each by a homography, anti-aliased by drawing at four times the size."""
    scale = 4
    image = np.full((CAMERA.height * scale, CAMERA.width * scale), 140, np.uint8)
    for identity, corners in tag_corners().items():
        tag = cv2.copyMakeBorder(
            opencv.marker_image(DICTIONARY, identity, 16), 16, 16, 16, 16, cv2.BORDER_CONSTANT, value=255
        )
        cells = opencv.marker_cells(DICTIONARY)
        low, high = 16 - 0.5, 16 + 16 * cells - 0.5
        source = np.float32([[low, low], [high, low], [high, high], [low, high]])
        pixels = project(CAMERA, transform(T_camera_target, corners))
        goal = np.float32((pixels + 0.5) * scale - 0.5)
        H = cv2.getPerspectiveTransform(source, goal)
        size = (image.shape[1], image.shape[0])
        drawn = cv2.warpPerspective(tag, H, size, flags=cv2.INTER_LINEAR)
        where = cv2.warpPerspective(np.full_like(tag, 255), H, size, flags=cv2.INTER_NEAREST) > 0
        image[where] = drawn[where]
    small = cv2.resize(image, (CAMERA.width, CAMERA.height), interpolation=cv2.INTER_AREA)
    return np.repeat(small[..., None], 3, axis=2)


@dataclass(frozen=True, kw_only=True)
class Clip:
    """Files of the clip, and its images in every form that a source may have."""

    folder: Path
    images: tuple[np.ndarray, ...]

    @property
    def stamps_ns(self) -> list[int]:
        return [PERIOD_NS * frame for frame in range(len(self.images))]

    def first(self, count: int) -> "Clip":
        """Its beginning."""
        return Clip(folder=self.folder, images=self.images[:count])

    def edited(self, edit: Edit) -> "Clip":
        """The same with changed images."""
        return Clip(folder=self.folder, images=tuple(edit(i, image.copy()) for i, image in enumerate(self.images)))

    def arguments(self, source: Path | str, out: Path, *more: str) -> list[str]:
        """The command line of track."""
        files = ["--target", str(self.folder / "target.toml"), "--camera", str(self.folder / "camera.yaml")]
        return ["track", str(source), "--detector", DETECTOR, *files, "-o", str(out), *more]

    def write_images(self, folder: Path) -> Path:
        folder.mkdir(parents=True)
        lines = ["image,stamp_ns"]
        for frame, (image, stamp_ns) in enumerate(zip(self.images, self.stamps_ns, strict=True)):
            cv2.imwrite(str(folder / f"{frame:06d}.png"), image)
            lines.append(f"{frame:06d}.png,{stamp_ns}")
        (folder / "stamps.csv").write_text("\n".join(lines) + "\n")
        return folder

    def write_bop(self, folder: Path) -> Path:
        self.write_images(folder / "rgb")
        poses = [true_pose(frame) for frame in range(len(self.images))]
        write_bop(folder, [BopFrame(frame=frame, K=CAMERA.K, T_camera_target=T) for frame, T in enumerate(poses)])
        return folder

    def write_video(self, path: Path) -> Path:
        from fairlead.video import VideoWriter

        with VideoWriter(path, codec="ffv1") as writer:
            for image, stamp_ns in zip(self.images, self.stamps_ns, strict=True):
                writer.write(image, stamp_ns)
        return path


def write_tag_target(path: Path, *, name: str = "book", sigma_m: float = 0.002) -> None:
    """target.toml with the exact corners."""
    lines = [f'name = "{name}"', 'mesh = "book.ply"', "[touchdown]", "position_m = [0.0, 0.0, 0.0]"]
    lines += ["[prior]", f"sigma_m = {sigma_m}"]
    for identity, corners in tag_corners().items():
        for corner, X in zip(("tl", "tr", "br", "bl"), corners.tolist(), strict=True):
            lines += ["[[landmark]]", f"name = {json.dumps(f'tag{identity}_{corner}')}", f"position_m = {X}"]
    path.write_text("\n".join(lines) + "\n")


def write_mesh(path: Path) -> None:
    """Two triangles a tag, as ASCII PLY."""
    vertices = np.concatenate(list(tag_corners().values()))
    faces = [(4 * i + a, 4 * i + b, 4 * i + c) for i in range(4) for a, b, c in ((0, 1, 2), (0, 2, 3))]
    header = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}", *(f"property float {a}" for a in "xyz")]
    header += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    body = [" ".join(f"{v:.9g}" for v in vertex) for vertex in vertices] + [f"3 {a} {b} {c}" for a, b, c in faces]
    path.write_text("\n".join(header + body) + "\n")


def make_clip(folder: Path, frames: int = FRAMES) -> Clip:
    """Draw the clip and write what belongs to it."""
    write_mesh(folder / "book.ply")
    write_tag_target(folder / "target.toml")
    save_camera(folder / "camera.yaml", CAMERA)
    poses = [true_pose(frame) for frame in range(frames)]
    write_truth(
        folder / "truth.csv",
        [TruthPose(frame=i, stamp_ns=PERIOD_NS * i, T_camera_target=T) for i, T in enumerate(poses)],
    )
    return Clip(folder=folder, images=tuple(draw(T) for T in poses))
