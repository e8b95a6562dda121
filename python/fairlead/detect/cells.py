# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""How far a tag's edges appear moved towards the white, told by the tag's own cells, docs/fiducials.md section 3.

A camera's tone curve, glare and the spread of ink make all black parts of a tag look wider or narrower by the same
width. The outer square and the cells inside then disagree about the grid, and that gives the width away.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from fairlead.detect.sampling import bilinear, level_crossing, smooth

Quad = Float64[np.ndarray, "4 2"]
Homography = Float64[np.ndarray, "3 3"]
Cells = Bool[np.ndarray, "c c"]
"""True where a cell is white, the black border of one cell included; row 0 is at the top of the upright tag."""

MIN_EDGES = 4
"""Fewer edges between cells tell nothing."""
_STATIONS = np.array([-0.15, -0.075, 0.0, 0.075, 0.15])
"""Places along each edge between two cells, as shares of a cell about its middle."""
_REACH = 0.7
"""Length of the profile to either side, as a share of a cell."""
_SAMPLES = 29
_BIWEIGHT = 4.0


@dataclass(frozen=True, kw_only=True, eq=False)
class CellEdges:
    """Edges between a black and a white cell that are parallel: n of them."""

    at: Float64[np.ndarray, "n"]
    """Place across the tag, 0 to 1."""
    middle: Float64[np.ndarray, "n"]
    """Place along the edge, 0 to 1."""
    brightens: Float64[np.ndarray, "n"]
    """+1 where the white cell follows the black one, -1 where it comes before."""
    cell: float
    """Size of a cell, as a share of the tag."""


@dataclass(frozen=True, kw_only=True)
class Spread:
    """How far black edges appear moved into the white."""

    width_px: float
    """NaN if unknown."""
    variance: float
    """[px^2]; infinite if unknown."""


UNKNOWN = Spread(width_px=float("nan"), variance=float("inf"))


def cell_edges(cells: Cells) -> tuple[CellEdges, CellEdges]:
    """The inner edges of a tag: those across rows (left to right), then those across columns (top to bottom)."""
    return _edges_across(cells), _edges_across(cells.T)


def _edges_across(cells: Cells) -> CellEdges:
    size = len(cells)
    change = cells[:, 1:].astype(np.float64) - cells[:, :-1]
    row, column = np.nonzero(change)
    return CellEdges(at=(column + 1) / size, middle=(row + 0.5) / size, brightens=change[row, column], cell=1.0 / size)


def homography(quad: Quad) -> Homography:
    """H with z ~ H (u, v, 1) that takes the unit square's corners to a quadrilateral, clockwise from (0, 0)."""
    A = np.zeros((8, 8))
    for i, ((u, v), (x, y)) in enumerate(zip(((0, 0), (1, 0), (1, 1), (0, 1)), quad, strict=True)):
        A[2 * i] = [u, v, 1, 0, 0, 0, -u * x, -v * x]
        A[2 * i + 1] = [0, 0, 0, u, v, 1, -u * y, -v * y]
    return np.append(np.linalg.solve(A, np.ravel(quad)), 1.0).reshape(3, 3)


def measure_spread(
    values: np.ndarray, H: Homography, edges: CellEdges, *, across_columns: bool, level: float, smoothing_px: float
) -> Spread:
    """Mean of how far each inner edge lies on its white side of where the outer square puts it.

    Parameters
    ----------
    values : grey values of the image
    H : from the tag's unit square to the image, after the spread assumed so far was taken off the outer square
    across_columns : the edges are met going down the tag instead of going right
    level : grey value that is the edge
    smoothing_px : Gaussian across the edge, as for the outer sides

    Where H has the right spread taken off, each edge is moved by the spread itself, docs/fiducials.md eq. (7).
    """
    if len(edges.at) < MIN_EDGES:
        return UNKNOWN
    along = edges.middle[:, None] + edges.cell * _STATIONS
    s = np.linspace(-_REACH * edges.cell, _REACH * edges.cell, _SAMPLES)
    across = edges.at[:, None] + s * edges.brightens[:, None]
    u, v = np.broadcast_arrays(across[:, None, :], along[:, :, None])
    if across_columns:
        u, v = v, u
    profiles = bilinear(values, _to_image(H, u, v))
    scale = _px_across(H, u[:, :, _SAMPLES // 2], v[:, :, _SAMPLES // 2], across_columns=across_columns)
    distance = s * scale[:, :, None]
    sigma = np.minimum(smoothing_px, _REACH * edges.cell * scale / 3.0)
    smoothed = smooth(profiles[:, :, None, :], distance, sigma)[:, :, 0, :]
    moved = level_crossing(smoothed, distance, np.full(smoothed.shape[:2], level))
    return _robust_mean(moved.mean(axis=1))


def _to_image(H: Homography, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Image points (..., 2) of points of the unit square."""
    z = np.stack([u, v, np.ones_like(u)], axis=-1) @ H.T
    return z[..., :2] / z[..., 2:]


def _px_across(H: Homography, u: np.ndarray, v: np.ndarray, *, across_columns: bool) -> np.ndarray:
    """Distance in the image between parallel grid lines, per unit of the tag: |det J| / |J e_along| [px]."""
    w = H[2, 0] * u + H[2, 1] * v + H[2, 2]
    point = _to_image(H, u, v)
    J = [(H[:2, axis] - point * H[2, axis]) / w[..., None] for axis in (0, 1)]
    determinant = J[0][..., 0] * J[1][..., 1] - J[0][..., 1] * J[1][..., 0]
    return np.abs(determinant) / np.linalg.norm(J[0 if across_columns else 1], axis=-1)


def _robust_mean(moved: np.ndarray) -> Spread:
    """Biweight mean over edges and the variance of the mean [px]."""
    found = moved[np.isfinite(moved)]
    if len(found) < MIN_EDGES:
        return UNKNOWN
    mean = float(np.median(found))
    scale = _BIWEIGHT * max(1.4826 * float(np.median(np.abs(found - mean))), 0.05)
    weight = np.ones_like(found)
    for _ in range(5):
        u = (found - mean) / scale
        weight = np.where(np.abs(u) < 1.0, (1.0 - u * u) ** 2, 0.0)
        mean = float((weight * found).sum() / weight.sum())
    kept = found[weight > 0.0]
    variance = float(((kept - mean) ** 2).sum()) / max(len(kept) - 1, 1) / len(kept)
    return Spread(width_px=mean, variance=variance)
