# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Figure 10: the target re-projected with each method's pose."""

from pathlib import Path

import numpy as np

from fairlead.evaluate.pose import rotation_error_deg, translation_error_m
from fairlead.geometry import project, transform
from fairlead.opencv import fill_triangles
from fairlead.reproduce import published
from fairlead.reproduce.content import Picture, Section
from fairlead.reproduce.context import Context
from fairlead.reproduce.detections import Network
from fairlead.reproduce.experiments.shared import NO_SEQUENCES, run_facts
from fairlead.reproduce.figures.overlay import FINER, Scene, draw_overlays
from fairlead.reproduce.methods import BATCH, EPNP, ONLINE, WINDOW
from fairlead.reproduce.pictures import picture_of
from fairlead.reproduce.sequences import Sequence
from fairlead.types import Camera, Matrix4

_METHODS = (EPNP, WINDOW, ONLINE, BATCH)
_WHERE = 0.85
"""Share of the flight after which the image is taken."""


def overlay(context: Context) -> Section:
    """One image of every sequence that has images, told model of seed 0, default network."""
    scenes: list[Scene] = []
    missing: list[str] = [] if context.sequences else [NO_SEQUENCES]
    for sequence in context.sequences:
        network = context.best_network(sequence)
        if network is None:
            missing.append(f"{sequence.name}: no network has looked at it")
        elif sequence.images is None or context.target.mesh is None:
            missing.append(f"{sequence.name}: no images, or no mesh of the target")
        else:
            scenes.append(_scene(context, sequence, network, context.target.mesh))
    caption = (
        "One image of each sequence, told model 0: yellow is the ship at the true pose, the line its outline at the "
        "pose of the method. The square is shown enlarged."
    )
    pictures = (
        [Picture(name="figure10", caption=caption, bitmap=draw_overlays(scenes), suffix=".jpg")] if scenes else []
    )
    return Section(
        name="overlay",
        title="Figure 10: the target re-projected",
        published=published.SEQUENCES,
        pictures=pictures,
        missing=missing,
        facts=run_facts(context),
    )


def _scene(context: Context, sequence: Sequence, network: Network, mesh: Path) -> Scene:
    row = min(round(_WHERE * len(sequence.truth)), len(sequence.truth) - 1)
    seeds = context.runs(sequence, network)
    triangles = _triangles(mesh)
    T_true = sequence.T_true[row]
    truth = silhouette(triangles, sequence.camera, T_true)
    methods: dict[str, tuple[np.ndarray | None, str]] = {}
    for method in _METHODS:
        T = seeds.tracks[0][method].T_camera_target[row]
        if not np.isfinite(T).all():
            methods[method] = (None, "no pose yet")
            continue
        rotation, translation = (float(e(T[None], T_true[None])[0]) for e in (rotation_error_deg, translation_error_m))
        words = f"{rotation:.2f} deg, {translation:.1f} m"
        methods[method] = (silhouette(triangles, sequence.camera, T, FINER), words)
    distance = float(np.linalg.norm(T_true[:3, 3]))
    return Scene(
        title=f"{sequence.name}, {distance:.0f} m",
        image=picture_of(sequence, sequence.truth[row].stamp_ns),
        truth=truth,
        methods=methods,
        inset=_inset(truth),
    )


def _triangles(mesh: Path) -> np.ndarray:
    import trimesh

    loaded = trimesh.load(mesh, force="mesh", process=False)
    return np.asarray(loaded.vertices, dtype=np.float64)[np.asarray(loaded.faces)]  # type: ignore[union-attr]


def silhouette(triangles: np.ndarray, camera: Camera, T_camera_target: Matrix4, finer: int = 1) -> np.ndarray:
    """What the target covers, in pixels `finer` times as fine, (finer h, finer w); under water as well."""
    p = transform(T_camera_target, triangles.reshape(-1, 3))
    with np.errstate(invalid="ignore", divide="ignore"):
        pixels = np.where(p[:, 2:] > 0.0, project(camera, p), np.nan)
    fine = finer * (np.nan_to_num(pixels, nan=1e9) + 0.5) - 0.5
    mask = np.zeros((finer * camera.height, finer * camera.width), np.uint8)
    fill_triangles(mask, fine.reshape(-1, 3, 2))
    return mask > 0


def _inset(mask: np.ndarray) -> tuple[int, int, int]:
    """About the highest point of the target: masts show a wrong attitude best."""
    rows, columns = np.nonzero(mask)
    top = int(rows.min())
    x = int(np.median(columns[rows == top]))
    side = max(round(0.28 * (columns.max() - columns.min())), 16)
    return x - side // 2, top - side // 5, side
