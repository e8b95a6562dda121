# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Renders a job: every frame that is not there yet, in one or more processes, then the tables."""

import signal
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context

import numpy as np

from fairlead import geometry
from fairlead.progress import ProgressFactory, silent
from fairlead.render.errors import RenderError
from fairlead.render.flights import Placed
from fairlead.render.frame_files import is_done, load_linear, make_folders, save_linear, write_frame
from fairlead.render.images import LinearImage, TruthImage
from fairlead.render.job import Backend, Job, horizon, open_backend
from fairlead.render.raycast import RayCaster
from fairlead.render.sensor import Sensor, develop, exposure_for
from fairlead.render.truth_tables import write_bop_tables, write_stamps, write_truth_tables
from fairlead.render.weather import Circumstances, apply_weather


def render_sequence(job: Job, *, jobs: int = 1, progress: ProgressFactory = silent) -> int:
    """Write the scene folder; frames that lie there already are kept. Returns how many were made.

    Raises RenderError where the machine or the target does not allow it, InputError for a mesh that cannot be read.
    """
    surface = job.surface()
    caster = RayCaster(surface)
    make_folders(job.folder, depth=job.depth, linear=_keeps_linear(job))
    write_truth_tables(job.folder, job.target, job.camera, job.placed, caster)
    write_stamps(job.folder, job.placed)
    missing = [k for k, p in enumerate(job.placed) if not is_done(job.folder, p.frame, depth=job.depth)]
    with progress("render", lambda: len(missing)) as advance:
        for _ in _rendered(job, missing, jobs):
            advance(1)
    write_bop_tables(job.folder, job.camera, job.placed)
    return len(missing)


def _keeps_linear(job: Job) -> bool:
    """Light that took minutes is kept, so that other weather costs nothing."""
    return job.quality == "full" and job.reuse is None


def _rendered(job: Job, indices: list[int], jobs: int) -> Iterator[int]:
    if jobs <= 1 or len(indices) <= 1:
        worker = FrameWorker(job)
        for index in indices:
            worker.make(index)
            yield index
        return
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn"), initializer=_start, initargs=(job,)) as pool:
        futures = [pool.submit(_make, index) for index in indices]
        try:
            for future in as_completed(futures):
                yield future.result()
        finally:
            for future in futures:
                future.cancel()


_workers: list["FrameWorker"] = []
"""The one worker of a process of the pool."""


def _start(job: Job) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent stops, and cancels what has not begun
    _workers.append(FrameWorker(job))


def _make(index: int) -> int:
    _workers[0].make(index)
    return index


class FrameWorker:
    """Makes frames of one job; the renderer is opened with the first frame that needs one."""

    def __init__(self, job: Job) -> None:
        self._job = job
        surface = job.surface()
        self._caster = RayCaster(surface)
        sky = job.surrounded(surface).sky
        self._air = horizon(sky)
        self._sun = sky.sun_direction
        self._exposure = exposure_for(sky.level_irradiance)
        self._backend: Backend | None = None

    def make(self, index: int) -> None:
        """Render or reload one frame, lay the weather over it, develop and write it."""
        job, placed = self._job, self._job.placed[index]
        image, truth = self._light(placed)
        sensor = Sensor(exposure=self._exposure)
        if job.weather is not None:
            image, sensor = apply_weather(image, sensor, job.weather, self._circumstances(placed))
        picture = develop(image.radiance, sensor, np.random.default_rng([job.seed, placed.frame, 3]))
        silhouette = np.isfinite(self._caster.depth(job.camera, placed.T_camera_target))
        write_frame(job.folder, placed.frame, picture, silhouette, truth, depth=job.depth)

    def _light(self, placed: Placed) -> tuple[LinearImage, TruthImage]:
        kept = load_linear(self._job.reuse or self._job.folder, placed.frame)
        if kept is not None:
            return kept
        if self._job.reuse is not None:
            raise RenderError(f"{self._job.reuse}: has no linear light of frame {placed.frame}")
        if self._backend is None:
            self._backend = open_backend(self._job)
        image, truth = self._backend.render(placed)
        if _keeps_linear(self._job):
            save_linear(self._job.folder, placed.frame, image, truth)
        return image, truth

    def _circumstances(self, placed: Placed) -> Circumstances:
        return Circumstances(
            camera=self._job.camera,
            T_camera_world=placed.T_camera_target @ geometry.inverse(placed.T_world_target),
            time_s=placed.stamp_ns * 1e-9,
            air=self._air,
            sun_world=self._sun,
            wind_m_s=self._job.setting.wind_m_s,
        )
