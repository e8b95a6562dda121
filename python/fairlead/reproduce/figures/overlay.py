# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The target projected with each method's pose over the image: truth in yellow, the method's outline in its colour."""

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fairlead.evaluate.figures.style import WIDTH_INCHES, styled
from fairlead.reproduce.figures.look import LOOKS, TRUTH
from fairlead.reproduce.methods import LABELS

FINER = 4


@dataclass(frozen=True, kw_only=True, eq=False)
class Scene:
    """One image of one sequence."""

    title: str
    image: np.ndarray
    """(h, w, 3) red, green, blue, 8 bits."""
    truth: np.ndarray
    """(h, w) bool"""
    methods: Mapping[str, tuple[np.ndarray | None, str]]
    """Method -> silhouette, FINER times as fine as the image (None: no pose), and what is written below."""
    inset: tuple[int, int, int]
    """Left, top and side of what is shown enlarged [px]."""


@styled
def draw_overlays(scenes: Sequence[Scene]) -> bytes:
    """A row per scene, a column per method. JPEG."""
    columns = list(scenes[0].methods)
    side = WIDTH_INCHES / len(columns)
    figure = Figure(figsize=(WIDTH_INCHES, (0.78 * side + 0.2) * len(scenes) + 0.2), layout="constrained")
    figure.get_layout_engine().set(w_pad=0.03, h_pad=0.03)  # type: ignore[union-attr]
    panels = figure.subplots(len(scenes), len(columns), squeeze=False)
    for row, (line, scene) in enumerate(zip(panels, scenes, strict=True)):
        for axes, method in zip(line, columns, strict=True):
            _panel(axes, scene, method, title=LABELS[method] if row == 0 else "")
        line[0].set_ylabel(scene.title, fontsize=8.5, fontweight="bold")
    buffer = io.BytesIO()
    figure.savefig(buffer, format="jpg", dpi=200, facecolor="white", pil_kwargs={"quality": 88})
    return buffer.getvalue()


def _panel(axes: Axes, scene: Scene, method: str, title: str) -> None:
    mask, words = scene.methods[method]
    left, top, right, bottom = frame_of(scene.truth)
    _lay(axes, scene, mask, method, wide=0.7)
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
    if title:
        axes.set_title(title, color=LOOKS[method].colour, fontsize=8.5)
    axes.set_xlabel(words, fontsize=7.5)
    x, y, side = scene.inset
    inset = axes.inset_axes((0.60, 0.50, 0.39, 0.49))
    _lay(inset, scene, mask, method, wide=1.2)
    inset.set_xlim(x, x + side)
    inset.set_ylim(y + side, y)
    for spine in inset.spines.values():
        spine.set(visible=True, color="white", linewidth=0.9)
    axes.add_patch(_box(x, y, side))


def _box(x: int, y: int, side: int):  # noqa: ANN202
    from matplotlib.patches import Rectangle

    return Rectangle((x, y), side, side, fill=False, ec="white", lw=0.7)


def _lay(axes: Axes, scene: Scene, mask: np.ndarray | None, method: str, wide: float) -> None:
    """The image, truth as a yellow veil, the outline of the method."""
    yellow = np.array([int(TRUTH[i : i + 2], 16) for i in (1, 3, 5)])
    veiled = scene.image.copy()
    veiled[scene.truth] = (0.45 * veiled[scene.truth] + 0.55 * yellow).astype(np.uint8)
    axes.imshow(veiled, interpolation="nearest", aspect="equal")
    if mask is not None:
        rows, columns = np.nonzero(mask.any(axis=1))[0], np.nonzero(mask.any(axis=0))[0]
        if not rows.size:
            return
        top, bottom = max(int(rows[0]) - 2, 0), int(rows[-1]) + 3
        left, right = max(int(columns[0]) - 2, 0), int(columns[-1]) + 3
        part = mask[top:bottom, left:right].astype(float)
        x = (np.arange(left, left + part.shape[1]) + 0.5) / FINER - 0.5
        y = (np.arange(top, top + part.shape[0]) + 0.5) / FINER - 0.5
        axes.contour(x, y, part, [0.5], colors=[LOOKS[method].colour], linewidths=[wide])
    axes.set_xticks([])
    axes.set_yticks([])
    axes.grid(visible=False)


def frame_of(mask: np.ndarray, aspect: float = 0.78) -> tuple[float, float, float, float]:
    """Left, top, right, bottom of what a panel shows: the target with air about it, higher than wide times `aspect`."""
    rows, columns = np.nonzero(mask.any(axis=1))[0], np.nonzero(mask.any(axis=0))[0]
    width = max(1.25 * (columns[-1] - columns[0]), 1.25 / aspect * (rows[-1] - rows[0]), 40.0)
    x, y = 0.5 * (columns[0] + columns[-1]), 0.5 * (rows[0] + rows[-1])
    return x - 0.42 * width, y - 0.5 * aspect * width, x + 0.58 * width, y + 0.5 * aspect * width
