# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The files of one frame of a sequence, and whether they are all there."""

from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import numpy as np

from fairlead.io.bop import MM_PER_M
from fairlead.opencv.filters import write_image
from fairlead.render.images import Distance, LinearImage, Mask, TruthImage
from fairlead.render.sensor import Picture

DEPTH_STEP_MM = 50.0
"""One step of a depth image: 16 bits of it reach 3.3 km."""


def picture_path(folder: Path, frame: int) -> Path:
    """rgb/000012.png."""
    return folder / "rgb" / f"{frame:06d}.png"


def mask_path(folder: Path, frame: int, *, visible: bool) -> Path:
    """mask_visib/000012_000000.png."""
    return folder / ("mask_visib" if visible else "mask") / f"{frame:06d}_000000.png"


def linear_path(folder: Path, frame: int) -> Path:
    """linear/000012.npz: light and truth before weather and sensor."""
    return folder / "linear" / f"{frame:06d}.npz"


def make_folders(folder: Path, *, depth: bool, linear: bool) -> None:
    """Every folder that frames are written to."""
    names = ["rgb", "mask", "mask_visib", *(["depth"] if depth else []), *(["linear"] if linear else [])]
    for name in names:
        (folder / name).mkdir(parents=True, exist_ok=True)


def is_done(folder: Path, frame: int, *, depth: bool) -> bool:
    """Whether a frame was written whole; the picture is written last."""
    needed = [picture_path(folder, frame)]
    if depth:
        needed.append(folder / "depth" / f"{frame:06d}.png")
    return all(path.is_file() for path in needed)


def write_frame(
    folder: Path, frame: int, picture: Picture, silhouette: Mask, truth: TruthImage, *, depth: bool
) -> None:
    """Masks, depth if wanted, and the picture."""
    for mask, visible in ((silhouette, False), (truth.mask, True)):
        write_image(mask_path(folder, frame, visible=visible), np.where(mask, np.uint8(255), np.uint8(0)))
    if depth:
        write_image(folder / "depth" / f"{frame:06d}.png", depth_image(truth.depth))
    write_image(picture_path(folder, frame), np.ascontiguousarray(picture[..., ::-1]))


def depth_image(depth: Distance) -> np.ndarray:
    """16 bits in steps of DEPTH_STEP_MM; 0 where there is no surface or none within reach."""
    steps = np.where(np.isfinite(depth), depth * (MM_PER_M / DEPTH_STEP_MM), 0.0)
    return np.where(steps <= 65535.0, np.round(steps), 0.0).astype(np.uint16)


def save_linear(folder: Path, frame: int, image: LinearImage, truth: TruthImage) -> None:
    """Half precision, compressed; whole or not at all."""
    path = linear_path(folder, frame)
    part = path.with_name(f".{path.name}.part")
    arrays = {
        "radiance": np.minimum(image.radiance, 6e4).astype(np.float16),
        "distance": image.distance.astype(np.float16),
        "mask": truth.mask,
        "depth": truth.depth,
    }
    with ZipFile(part, "w", ZIP_DEFLATED, compresslevel=1) as archive:  # numpy's level takes twice as long
        for name, array in arrays.items():
            with archive.open(f"{name}.npy", "w") as stream:
                np.lib.format.write_array(stream, array, allow_pickle=False)
    part.replace(path)


def load_linear(folder: Path, frame: int) -> tuple[LinearImage, TruthImage] | None:
    """What save_linear wrote; None if there is nothing."""
    path = linear_path(folder, frame)
    if not path.is_file():
        return None
    with np.load(path, allow_pickle=False) as arrays:
        image = LinearImage(
            radiance=arrays["radiance"].astype(np.float32), distance=arrays["distance"].astype(np.float32)
        )
        return image, TruthImage(mask=arrays["mask"], depth=arrays["depth"])
