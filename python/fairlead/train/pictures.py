# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Held-out pictures to measure a network on: labelled crops, or windows of a flight. docs/networks.md section 5."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fairlead import geometry
from fairlead.io.bop import BopFrame, is_bop, read_bop
from fairlead.io.camera import load_camera
from fairlead.io.csv_lines import read_csv
from fairlead.io.errors import InputError
from fairlead.io.poses import read_truth
from fairlead.io.target import load_target
from fairlead.opencv import Image, read_image
from fairlead.opencv.crops import cut_resized
from fairlead.train.crops import read_folders
from fairlead.types import Camera, Matrix4
from fairlead.video import open_video, pictures
from fairlead.video.clip import CLIP

PAD = 1.25
"""Side of a window over that of the landmarks' box."""
MISPLACED, MISSIZED = 0.04, 0.08
"""How far a tracker's prediction is off: share of the side, log of the factor; one standard deviation."""
COLUMNS = ("frame", "stamp_ns", "landmark", "u_px", "v_px", "depth_m", "state")
STATES = {"outside": 0, "hidden": 1, "visible": 2}


@dataclass(frozen=True, kw_only=True, eq=False)
class Picture:
    """A crop and everything that is known of it; pixels of the crop."""

    image: Image
    pixels: np.ndarray
    """(n, 2)"""
    visibility: np.ndarray
    """(n,): 0 outside, 1 hidden, 2 visible."""
    focal_px: float
    T_camera_target: Matrix4

    @property
    def camera(self) -> Camera:
        """That sees the target so large; where its axis is does not matter to derivatives."""
        height, width = self.image.shape[:2]
        K = np.diag([self.focal_px, self.focal_px, 1.0])
        return Camera(name="crop", width=width, height=height, model="pinhole", K=K, distortion=np.zeros(0))


def open_pictures(folder: Path, landmarks: tuple[str, ...], size: int, seed: int) -> tuple[int, Iterator[Picture]]:
    """How many, and the pictures of a folder of crops or of a sequence. Raises InputError where landmarks differ."""
    if is_sequence(folder):
        return len(_truth(folder)), _windows(folder, landmarks, size, seed)
    names, labelled = read_folders([folder])
    if names != landmarks:
        raise InputError(folder, f"expected labels of {', '.join(landmarks)}, which the network knows")

    def crops() -> Iterator[Picture]:
        for each in labelled:
            image = read_image(each.path)
            height, width = image.shape[:2]
            if height != width:
                raise InputError(each.path, f"expected a square, got {width} x {height} px")
            scale = size / width
            yield Picture(
                image=image if width == size else cut_resized(image, (0, 0), (width, width), (size, size)),
                pixels=(each.label.pixels + 0.5) * scale - 0.5,
                visibility=np.array(each.label.visibility),
                focal_px=float(each.label.K[0, 0]) * scale,
                T_camera_target=each.label.T_camera_target,
            )

    return len(labelled), crops()


def is_sequence(folder: Path) -> bool:
    """Whether it holds a flight, as images or as a clip, and not crops."""
    return is_bop(folder) or (folder / CLIP).is_file()


def _truth(folder: Path) -> list[BopFrame]:
    """Camera and pose of every frame of a flight."""
    if is_bop(folder):
        return read_bop(folder)
    K = load_camera(folder / "camera.yaml").K
    poses = read_truth(folder / "truth.csv")
    return [BopFrame(frame=pose.frame, K=K, T_camera_target=pose.T_camera_target) for pose in poses]


def _images(folder: Path, numbers: Iterable[int]) -> Iterator[tuple[int, Image]]:
    """Images of a flight by their numbers; of a clip all that it has."""
    if is_bop(folder):
        for number in numbers:
            yield number, read_image(folder / "rgb" / f"{number:06d}.png")
        return
    with open_video(folder / CLIP) as container:
        for number, picture in enumerate(pictures(container, named=str(folder / CLIP))):
            yield number, picture.image


def _windows(folder: Path, landmarks: tuple[str, ...], size: int, seed: int) -> Iterator[Picture]:
    """Squares about the landmarks' box, misplaced as a tracker misplaces them; frames without the target left out."""
    target = load_target(folder / "target_true.toml")
    if target.landmarks != landmarks:
        raise InputError(folder, f"expected the landmarks {', '.join(landmarks)}, which the network knows")
    table = _true_landmarks(folder / "landmarks_true.csv", landmarks)
    truth = {frame.frame: frame for frame in _truth(folder)}
    for number, image in _images(folder, truth):
        if number not in truth or not (table[number][1] > 0).any():
            continue
        frame, (pixels, states) = truth[number], table[number]
        rng = np.random.default_rng([seed, number])
        low, high = pixels[states > 0].min(axis=0), pixels[states > 0].max(axis=0)
        side = max(16, round(PAD * float((high - low).max()) * float(np.exp(MISSIZED * rng.standard_normal()))))
        middle = 0.5 * (low + high) + MISPLACED * side * rng.standard_normal(2)
        corner = np.round(middle + 0.5 - 0.5 * side).astype(int)
        moved = (pixels - corner + 0.5) * (size / side) - 0.5  # docs/rendering.md eq. (4); corner + 1/2 is a centre
        inside = np.all((moved > -0.5) & (moved < size - 0.5), axis=1)
        yield Picture(
            image=cut_resized(image, (int(corner[0]), int(corner[1])), (side, side), (size, size)),
            pixels=moved,
            visibility=np.where(inside, states, 0),
            focal_px=float(frame.K[0, 0]) * size / side,
            T_camera_target=frame.T_camera_target,
        )


def _true_landmarks(path: Path, landmarks: tuple[str, ...]) -> dict[int, tuple[np.ndarray, np.ndarray]]:
    """Pixels (n, 2) and states (n,) of every frame."""
    index = {name: k for k, name in enumerate(landmarks)}
    table: dict[int, tuple[np.ndarray, np.ndarray]] = {}
    for line, row in read_csv(path, COLUMNS):
        try:
            pixels, states = table.setdefault(int(row["frame"]), (np.zeros((len(index), 2)), np.zeros(len(index), int)))
            k, state = index[row["landmark"]], STATES[row["state"]]
            if state:
                pixels[k], states[k] = (float(row["u_px"]), float(row["v_px"])), state
        except (KeyError, ValueError) as error:
            raise InputError(path, f"unexpected {error}", line=line) from error
    return table


def seen_from(T_camera_target: Matrix4, middle: np.ndarray) -> tuple[float, float]:
    """Range [m] to a point of the target, and the camera's azimuth about it [deg]: 0 ahead (x), 90 to port (y).

    NaN where the target is behind the camera.
    """
    if geometry.transform(T_camera_target, middle[None])[0, 2] <= 0.0:
        return float("nan"), float("nan")
    eye = geometry.inverse(T_camera_target)[:3, 3] - middle
    return float(np.linalg.norm(eye)), float(np.degrees(np.arctan2(eye[1], eye[0])))
