# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A rendered sequence as a clip with its truth, small enough to be kept. docs/rendering.md section 10."""

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np

from fairlead.opencv import read_image
from fairlead.progress import ProgressFactory, silent
from fairlead.render.errors import RenderError
from fairlead.render.frame_files import picture_path
from fairlead.render.job import Job
from fairlead.render.raycast import RayCaster
from fairlead.render.truth_tables import write_truth_tables
from fairlead.video.clip import CLIP, TICK_NS, ClipWriter


def write_clip(job: Job, folder: Path, *, crf: float, progress: ProgressFactory = silent) -> None:
    """Encode the pictures of a rendered scene, and write the truth of them; here frames count from 0.

    Raises RenderError if the stamps are not whole milliseconds or the pictures are odd in size, OSError.
    """
    camera, placed = job.camera, job.placed
    stamps = [each.stamp_ns for each in placed]
    if any(stamp % TICK_NS for stamp in stamps) or (np.diff(stamps) <= 0).any():
        raise RenderError("--clip: expected stamps that rise by whole milliseconds, which is what the file can hold")
    if camera.width % 2 or camera.height % 2:
        raise RenderError(f"--clip: expected an even size, got {camera.width} x {camera.height}")
    folder.mkdir(parents=True, exist_ok=True)
    part = folder / f".{CLIP}.part"
    with (
        ClipWriter(part, camera.width, camera.height, rate_hz=_rate(stamps), crf=crf) as writer,
        progress("encode", lambda: len(placed)) as advance,
    ):
        for each in placed:
            writer.write(read_image(picture_path(job.folder, each.frame)), each.stamp_ns)
            advance(1)
    part.replace(folder / CLIP)
    numbered = [replace(each, frame=k) for k, each in enumerate(placed)]
    write_truth_tables(folder, job.target, camera, numbered, RayCaster(job.surface()))


def _rate(stamps: list[int]) -> Fraction:
    """Pictures per second, for players; the stamps say it exactly."""
    step = int(np.median(np.diff(stamps))) if len(stamps) > 1 else 10**9
    return Fraction(10**9, step)
