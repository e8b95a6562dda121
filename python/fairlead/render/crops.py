# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Training crops of any target with a mesh: varied in everything, labelled exactly. docs/rendering.md section 8."""

import json
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import UInt8

from fairlead import geometry
from fairlead.io.coco import LabelledImage, label_json, write_coco
from fairlead.opencv.filters import resized, write_image
from fairlead.progress import ProgressFactory, silent
from fairlead.render.crop_scene import CropScene, Stage
from fairlead.render.crop_view import Envelope, behind_camera, draw_view
from fairlead.render.disturbances import draw_obstacle, draw_sensor, smeared, tinted
from fairlead.render.errors import RenderError
from fairlead.render.images import LinearImage
from fairlead.render.job import Quality, horizon
from fairlead.render.raster.model import Shot
from fairlead.render.raster.renderer import Renderer
from fairlead.render.sensor import Picture, develop
from fairlead.render.surface_file import load_surface
from fairlead.render.surroundings import Kind
from fairlead.render.truth_tables import see
from fairlead.render.weather import KINDS, Circumstances, Weather, apply_weather
from fairlead.types import Camera, Target

BLOCK = 128
"""Crops that share sky, sea and shape, which cost a second to make."""
PAINT_EVERY = 8
LABELS = "labels.jsonl"
ANNOTATIONS = "annotations.json"


@dataclass(frozen=True, kw_only=True, eq=False)
class CropJob:
    """Which crops. The same job gives the same crops, block by block, in any order."""

    target: Target
    camera: Camera
    """That of the flight: a crop is cut out of its image, with its sharpness."""
    folder: Path
    count: int
    envelope: Envelope
    size: int = 256
    seed: int = 0
    surroundings: Kind = "sea"
    quality: Quality = "draft"
    samples: int = 16
    """Light paths per pixel, full quality only."""
    threads: int | None = None
    """Of Cycles; one per core if None."""
    weather_share: float = 0.35
    """How many crops have weather [-]."""
    empty_share: float = 0.0
    """How many crops have no target in them, and often another ship in its place [-]."""


def render_crops(job: CropJob, *, jobs: int = 1, progress: ProgressFactory = silent) -> int:
    """Write images/, labels.jsonl and at the end annotations.json; blocks that are there are kept. Returns how many
    crops were made. Errors as render_sequence.
    """
    if job.target.mesh is None:
        raise RenderError(f'target {job.target.name} names no mesh: add mesh = "..." to its target.toml')
    (job.folder / "images").mkdir(parents=True, exist_ok=True)
    labels = _labels_there(job.folder / LABELS)
    blocks = [b for b in range(-(-job.count // BLOCK)) if not all(i in labels for i in _numbers(job, b))]
    total = sum(len(_numbers(job, block)) for block in blocks)
    with progress("crops", lambda: total) as advance, (job.folder / LABELS).open("a", encoding="utf-8") as stream:
        for block in _rendered(job, blocks, jobs):
            for label in block:
                labels[label["id"]] = label
                stream.write(json.dumps(label) + "\n")
            stream.flush()
            advance(len(block))
    wanted = [labels[number] for number in range(job.count)]
    write_coco(job.folder / ANNOTATIONS, job.target.name, job.target.landmarks, wanted)
    return total


def _numbers(job: CropJob, block: int) -> range:
    return range(block * BLOCK, min((block + 1) * BLOCK, job.count))


def _labels_there(path: Path) -> dict[int, dict[str, Any]]:
    """Labels of earlier runs whose pictures exist; a torn last line is left out."""
    labels: dict[int, dict[str, Any]] = {}
    if not path.is_file():
        return labels
    for line in path.read_text(encoding="utf-8").splitlines():
        try:
            label = json.loads(line)
            if (path.parent / label["image"]["file_name"]).is_file():
                labels[int(label["id"])] = label
        except (ValueError, KeyError, TypeError):
            continue
    return labels


def _rendered(job: CropJob, blocks: list[int], jobs: int) -> Iterator[list[dict[str, Any]]]:
    if jobs <= 1 or len(blocks) <= 1:
        maker = CropMaker(job) if blocks else None
        for block in blocks:
            assert maker is not None
            yield maker.make(block)
        return
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn"), initializer=_start, initargs=(job,)) as pool:
        futures = [pool.submit(_make, block) for block in blocks]
        try:
            for future in as_completed(futures):
                yield future.result()
        finally:
            for future in futures:
                future.cancel()


_makers: list["CropMaker"] = []


def _start(job: CropJob) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent stops, and cancels what has not begun
    _makers.append(CropMaker(job))


def _make(block: int) -> list[dict[str, Any]]:
    return _makers[0].make(block)


class CropMaker:
    """Makes the crops of one job, block by block."""

    def __init__(self, job: CropJob) -> None:
        assert job.target.mesh is not None
        self._job = job
        surface = load_surface(job.target.mesh)
        self._renderer = Renderer(job.size, job.size)
        self._stage = Stage(self._renderer, job.target, surface, job.surroundings, job.envelope.R_level_target)

    def make(self, block: int) -> list[dict[str, Any]]:
        """Write the pictures of a block; returns their labels."""
        scene = self._stage.set(np.random.default_rng([self._job.seed, block, 1]))
        light = self._light_of(scene)
        labels: list[dict[str, Any]] = []
        for number in _numbers(self._job, block):
            rng = np.random.default_rng([self._job.seed, number, 2])
            if number % PAINT_EVERY == 0 and self._job.quality == "draft":
                self._stage.paint(np.random.default_rng([self._job.seed, number, 3]))
            labels.append(self._crop(number, scene, light, rng))
        return labels

    def _light_of(self, scene: CropScene) -> Callable[[Shot, int], LinearImage]:
        """What turns a shot, and a seed, into light."""
        if self._job.quality == "draft":
            return lambda shot, _: self._renderer.draw(shot, self._stage.model)
        from fairlead.render.cycles.tracer import Tracer

        stage, surroundings = self._stage, scene.surroundings
        job = self._job
        tracer = Tracer(self._renderer, stage.model, stage.painted, surroundings, job.samples, job.threads)
        return lambda shot, seed: tracer.render(shot, scene.waves, seed)[0]

    def _crop(
        self, number: int, scene: CropScene, light: Callable[[Shot, int], LinearImage], rng: np.random.Generator
    ) -> dict[str, Any]:
        job = self._job
        view = draw_view(scene.X, job.camera, job.envelope, job.size, rng)
        T_world_target = self._stage.place(rng)
        shot = Shot(
            camera=view.native,
            T_camera_target=view.T_camera_target,
            T_world_target=T_world_target,
            others=self._stage.others(T_world_target, rng),
        )
        shot = self._without_target(number, shot)
        image = light(shot, number)
        seen = see(_moved(job.target, scene), view.camera, shot.T_camera_target, scene.caster)
        visibility = np.array([{"outside": 0, "hidden": 1, "visible": 2}[state] for state in seen.states])
        picture, covered = self._photograph(image, shot, scene, rng)
        if job.surroundings == "room":  # where things stand so near that they hide parts of the target
            truth = self._renderer.truth(shot, self._stage.model)
            covered |= np.isfinite(truth.depth) & ~truth.mask
        for k in np.nonzero(visibility == 2)[0]:
            place = (seen.pixels[k] + 0.5) * (view.native.width / job.size)
            u, v = np.clip(np.floor(place), 0, view.native.width - 1).astype(int)
            visibility[k] = 1 if covered[v, u] else 2
        name = f"images/{number:06d}.jpg"
        write_image(job.folder / name, np.ascontiguousarray(picture[..., ::-1]), quality=int(rng.integers(70, 97)))
        low, high = _box(seen.pixels, job.size)
        return label_json(
            LabelledImage(
                number=number,
                file_name=name,
                width=job.size,
                height=job.size,
                pixels=np.where(visibility[:, None] > 0, seen.pixels, 0.0),
                visibility=tuple(visibility.tolist()),
                box=(float(low[0]), float(low[1]), float(high[0] - low[0]), float(high[1] - low[1])),
                K=view.camera.K,
                T_camera_target=shot.T_camera_target,
            )
        )

    def _without_target(self, number: int, shot: Shot) -> Shot:
        """The same shot, or, in a share of the crops, with the target behind the camera and often another ship.

        Of these every other is seen from where it looks as large as the target would: so a detector frames it. Seven of
        ten have the wake.
        """
        rng = np.random.default_rng([self._job.seed, number, 4])
        if rng.random() >= self._job.empty_share:
            return shot
        T_camera_place, T_world_place, others = shot.T_camera_target, shot.T_world_target, list(shot.others)
        wake = None
        other = self._stage.stand_in(rng)
        if other is not None:
            if rng.random() < 0.5:
                model = self._stage.model
                T_camera_place = T_camera_place.copy()
                T_camera_place[:3, 3] *= (other.high[0] - other.low[0]) / (model.high[0] - model.low[0])
            turn = geometry.exp_se3(np.array([0.0, 0.0, 0.0, 0.0, 0.0, rng.uniform(0.0, 2.0 * np.pi)]))
            others.append((other, T_world_place @ turn))
            wake = T_world_place @ turn if rng.random() < 0.7 else None
        away = behind_camera(T_camera_place, T_world_place)
        return replace(
            shot,
            T_camera_target=T_camera_place @ away,
            T_world_target=T_world_place @ away,
            others=others,
            T_world_wake=wake,
        )

    def _photograph(
        self, image: LinearImage, shot: Shot, scene: CropScene, rng: np.random.Generator
    ) -> tuple[Picture, np.ndarray]:
        """The picture as the flight's camera would have made it, and which pixels something stands before."""
        sky, size = scene.surroundings.sky, shot.camera.width
        sensor = draw_sensor(scene.surroundings.metered, rng)
        if self._job.surroundings == "sea" and rng.random() < self._job.weather_share:
            weather = Weather(
                kind=KINDS[int(rng.integers(len(KINDS)))], strength=float(rng.uniform(0.05, 0.75)), seed=1
            )
            frame = Circumstances(
                camera=shot.camera,
                T_camera_world=shot.T_camera_world,
                time_s=float(rng.uniform(0.0, 1000.0)),
                air=horizon(sky),
                sun_world=sky.sun_direction,
            )
            image, sensor = apply_weather(image, sensor, weather, frame)
        light = tinted(image.radiance, rng)
        covered = np.zeros((size, size), bool)
        if rng.random() < 0.25:
            for _ in range(int(rng.integers(1, 3))):
                obstacle = draw_obstacle(size, 1.0 / sensor.exposure, rng)
                light = obstacle.over(light)
                covered |= obstacle.cover > 0.5
        if rng.random() < 0.2:
            light = smeared(light, rng)
        return _enlarged(develop(light, sensor, rng), self._job.size), covered


def _moved(target: Target, scene: CropScene) -> Target:
    """The target with its landmarks on the varied shape."""
    zero = np.zeros_like(target.covariance)
    return Target(name=target.name, landmarks=target.landmarks, positions=scene.X, covariance=zero)


def _enlarged(picture: Picture, size: int) -> UInt8[np.ndarray, "size size 3"]:
    """As the tracker enlarges what its camera shows in few pixels."""
    if len(picture) == size:
        return picture
    return np.clip(np.round(resized(picture.astype(np.float32), size, size)), 0, 255).astype(np.uint8)


def _box(pixels: np.ndarray, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Top-left and bottom-right of the landmarks in the crop [px]; zeros where the target is behind the camera."""
    if np.isnan(pixels).all():
        return np.zeros(2), np.zeros(2)
    ends = np.nanmin(pixels, axis=0), np.nanmax(pixels, axis=0)
    low, high = (np.clip(end, -0.5, size - 0.5) for end in ends)
    return low, high
