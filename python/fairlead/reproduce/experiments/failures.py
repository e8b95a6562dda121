# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures 17 and 18: where each method breaks, and what covariance and status say there."""

import dataclasses
from collections.abc import Sequence as Rows

import numpy as np

from fairlead.baselines.observed import plain
from fairlead.io.camera import load_camera
from fairlead.io.shipped import shipped_data
from fairlead.progress import Progress
from fairlead.reproduce import published
from fairlead.reproduce.content import Cell, Column, Picture, Section, Table
from fairlead.reproduce.context import Context
from fairlead.reproduce.figures.breaking import Axis, draw_breaking
from fairlead.reproduce.methods import BATCH, EPNP, LABELS, ONLINE, WINDOW, Track
from fairlead.reproduce.scores import errors_of, score, summarise
from fairlead.reproduce.simulated import Hardship, hard_flight
from fairlead.reproduce.work import Job, run_job

METHODS = (EPNP, WINDOW, ONLINE, BATCH)
AXES: tuple[tuple[str, str, tuple[float, ...], float], ...] = (
    ("sigma_px", "noise [px]", (0.5, 1.0, 2.0, 4.0, 8.0, 16.0), 1.0),
    ("angle_deg", "angle [deg]", (2.0, 5.0, 15.0, 45.0, 90.0, 180.0), 1.0),
    ("outliers", "outliers of 30 px [%]", (0.0, 0.1, 0.2, 0.3, 0.4, 0.5), 100.0),
    ("occluded", "landmarks hidden [%]", (0.0, 0.25, 0.5, 0.65, 0.75, 0.85), 100.0),
)
"""Field of Hardship, label, levels, and what they are multiplied by where people read them."""
_COLUMNS = (
    Column(key="level", title="level", plain=True),
    Column(key="label", title="method"),
    Column(key="rotation_all_deg", title="rotation [deg]"),
    Column(key="translation_all_m", title="translation [m]", interval=True),
    Column(key="failed", title="failed [%]", percent=True, digits=2),
    Column(key="wrong", title="of it with a wrong pose [%]", percent=True, digits=2),
    Column(key="model_m", title="model [m]"),
    Column(key="truthful", title="rms error / stated", digits=2),
    Column(key="pose_nees_median", title="NEES / 6, median", digits=2),
    Column(key="status", title="status: tracking / coasting / lost or acquiring [%]"),
)


def failures(context: Context) -> Section:
    """Four axes, each alone, at the level of landmarks; weather has a section of its own."""
    runs = 3 if context.config.quick else 10
    count = sum(len(levels) for _, _, levels, _ in AXES) * runs
    tables: list[Table] = []
    axes: list[Axis] = []
    with context.progress("failures", lambda: count) as advance:
        for name, label, levels, scale in AXES:
            rows = [row for level in levels for row in _rows(context, name, level, scale, runs, advance)]
            tables.append(Table(name=f"failures_{name}", title=f"Against {label}", columns=_COLUMNS, rows=rows))
            axes.append(Axis(label=label, levels=[scale * level for level in levels], rows=rows, methods=METHODS))
    caption = (
        "Top: mean translation error, failed frames with their limit of 25 % of the range; dotted: the window from "
        "its first pose on. Middle: share of failed frames, without a pose or with a useless one. Bottom: root mean "
        "square error over what the covariance states; 1 is true, above it is over-confident. Arc at 1 km, 60 views, "
        "model error 1 m; what is not varied: 1 px, 90 deg, no outliers."
    )
    return Section(
        name="failures",
        title="Figures 17 and 18: where each method breaks",
        published=published.FAILURES,
        words=[_WORDS],
        tables=tables,
        pictures=[Picture(name="figure17", caption=caption, figure=draw_breaking(axes))],
        facts={"runs a level": str(runs), "data": "simulated landmarks, no images"},
    )


_WORDS = (
    "Means count failed frames with their limits (30 deg, 25 % of the range), so silence does not help. 'Stated' is "
    "the root of the mean variance of the translation that the covariance tells; of EPnP and the window it is that "
    "of the pixel noise alone, because they take the model as exact. Hidden landmarks vanish from the bow on after "
    "ten views."
)


def _rows(
    context: Context, name: str, level: float, scale: float, runs: int, advance: Progress
) -> list[dict[str, Cell]]:
    camera = plain(load_camera(shipped_data("frigate") / "camera.yaml"))
    hardship = dataclasses.replace(Hardship(), **{name: level})
    scores: dict[str, list[dict[str, float]]] = {method: [] for method in METHODS}
    tracks: dict[str, list[tuple[Track, np.ndarray]]] = {method: [] for method in METHODS}
    for seed in range(runs):
        flight = hard_flight(context.target, camera, hardship, seed)
        found = run_job(
            Job(flight=flight, name=f"failures/{name}-{level:g}/{seed:03d}", methods=METHODS), context.cache / "runs"
        )
        for method in METHODS:
            scores[method].append(score(found[method], flight))
            tracks[method].append((found[method], flight.T_true))
        advance(1)
    rows: list[dict[str, Cell]] = []
    for method in METHODS:
        head: dict[str, Cell] = {"level": scale * level, "method": method, "label": LABELS[method]}
        words: dict[str, Cell] = {"status": statuses([track for track, _ in tracks[method]])}
        rows.append(head | summarise(scores[method]) | {"truthful": truthful(tracks[method])} | words)
    return rows


def truthful(tracks: Rows[tuple[Track, np.ndarray]]) -> float:
    """Root mean square translation error over the root of the mean stated variance, frames with a pose."""
    errors, stated = [], []
    for track, T_true in tracks:
        e = errors_of(track, T_true)
        errors.append(e.translation_m)
        stated.append(e.sigma_translation_m)
    error, sigma = np.concatenate(errors), np.concatenate(stated)
    known = np.isfinite(error) & np.isfinite(sigma)
    if not known.any():
        return float("nan")
    return float(np.sqrt((error[known] ** 2).mean() / (sigma[known] ** 2).mean()))


def statuses(tracks: Rows[Track]) -> str:
    """Shares of the frames in per cent."""
    status = np.concatenate([track.status for track in tracks])
    shares = (status == 1, status == 2, (status != 1) & (status != 2))
    return " / ".join(f"{100.0 * share.mean():.0f}" for share in shares)
