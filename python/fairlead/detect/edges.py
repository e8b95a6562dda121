# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Corners of tags from lines fitted to their four sides, with covariances from the residuals, docs/fiducials.md."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from fairlead.detect.cells import cell_edges, homography, measure_spread
from fairlead.detect.lines import Lines, fit_lines
from fairlead.detect.sampling import bilinear, level_crossing, smooth
from fairlead.opencv import GreyImage

Quads = Float64[np.ndarray, "t 4 2"]
QuadCovariances = Float64[np.ndarray, "t 4 2 2"]
Sides = Float64[np.ndarray, "t 4"]
Patterns = Bool[np.ndarray, "t c c"]
"""Cells of each tag: fairlead.detect.cells.Cells."""
Profiles = Float64[np.ndarray, "t 4 m s"]

STATIONS = 48
"""Places along a side where the edge is looked for."""
SAMPLES = 41
"""Grey values across the edge at each place."""
PASSES = 3
END_MARGIN = 0.12
"""Share of a side, at either end, that the corner's own blur may have bent."""
MIN_MARGIN_PX = 2.0
CELL_SHARE = 0.8
"""A profile stays within this share of a cell, so that it meets one edge alone."""
FIRST_HALF_WIDTH_PX = 6.0
MIN_HALF_WIDTH_PX = 1.5
SMOOTHING_PX = 1.0
"""Gaussian across the edge: the matched filter of a blur of this size."""
SPREAD_STEPS = 4
"""Rounds of taking the spread off and measuring it again; each leaves less than a third of its error."""
SPREAD_FLOOR_PX = 0.1
"""Spread of ink and glare that is expected of any tag, one standard deviation [px]."""
MIN_SINE = 0.01
"""Of the angle between neighbouring sides."""
MIN_CONTRAST = 8.0
"""Grey levels between the tag's black and its surroundings."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TagCorners:
    """What was measured of t tags."""

    corners: Quads
    """[px]"""
    covariances: QuadCovariances
    """[px^2]"""
    measured: Bool[np.ndarray, "t"]
    """False where a side could not be seen: those rows are NaN."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Edges:
    """The edge at each station, as offset along the outward normal [px]; NaN where there is none."""

    along: Float64[np.ndarray, "t 4 m"]
    """Position along the side, from its middle [px]."""
    offset: Float64[np.ndarray, "t 4 m"]
    blur: Sides
    """Distance between the quarter and three quarter levels [px]."""
    level: Float64[np.ndarray, "t"]
    """Grey value half way between black and white."""
    tone: Sides
    """From the half level of the pixel values to the half level of the light, docs/fiducials.md eq. (5) [px]."""


def measure_tags(image: GreyImage, guesses: Quads, patterns: Patterns) -> TagCorners:
    """Intersect lines fitted to the sides of each tag, docs/fiducials.md eq. (1)-(8).

    Parameters
    ----------
    image : grey values
    guesses : corners to about a pixel, clockwise as seen, the first being top left when the tag is upright
    patterns : cells of each tag, True where white, black border included

    A tag is not measured if a side leaves the image, has no contrast, or is no line.
    """
    cells = patterns.shape[-1]
    values = image.astype(np.float64)
    quads = guesses
    half_widths = np.clip(CELL_SHARE * _cell_depths(quads, cells), MIN_HALF_WIDTH_PX, FIRST_HALF_WIDTH_PX)
    edges = _find_edges(values, quads, half_widths)
    lines = fit_lines(edges.along, edges.offset)
    for _ in range(PASSES - 1):
        quads = _intersect(quads, lines)
        limits = np.maximum(CELL_SHARE * _cell_depths(quads, cells), MIN_HALF_WIDTH_PX)
        wanted = np.nan_to_num(2.5 * edges.blur + 0.5, nan=FIRST_HALF_WIDTH_PX)
        edges = _find_edges(values, quads, np.clip(wanted, MIN_HALF_WIDTH_PX, limits))
        lines = fit_lines(edges.along, edges.offset)
    corners, covariances = _without_spread(values, quads, lines, edges, patterns)
    travelled = np.linalg.norm(corners - guesses, axis=2).max(axis=1)
    with np.errstate(invalid="ignore"):
        near = travelled < _directions(guesses)[2].max(axis=1) / cells
    measured = near & np.isfinite(corners).all(axis=(1, 2)) & np.isfinite(covariances).all(axis=(1, 2, 3))
    corners[~measured] = np.nan
    covariances[~measured] = np.nan
    return TagCorners(corners=corners, covariances=covariances, measured=measured)


def _without_spread(
    values: np.ndarray, quads: Quads, lines: Lines, edges: _Edges, patterns: Patterns
) -> tuple[Quads, QuadCovariances]:
    """Corners and covariances after the sides were moved in by the spread that the cells tell, eq. (7)-(8)."""
    prior = edges.tone**2 / 3.0 + SPREAD_FLOOR_PX**2
    inward, variance = np.zeros_like(prior), prior.copy()
    for tag in np.flatnonzero(np.isfinite(lines.offset).all(axis=1)):
        inner = cell_edges(patterns[tag])
        for _ in range(SPREAD_STEPS):
            moved = _intersect(quads, lines, inward)[tag]
            if not np.isfinite(moved).all():
                break
            H = homography(moved)
            for sides, across_columns in (([1, 3], False), ([0, 2], True)):
                spread = measure_spread(
                    values,
                    H,
                    inner[int(across_columns)],
                    across_columns=across_columns,
                    level=float(edges.level[tag]),
                    smoothing_px=SMOOTHING_PX,
                )
                if np.isfinite(spread.width_px):
                    gain = prior[tag, sides] / (prior[tag, sides] + spread.variance)
                    inward[tag, sides] = gain * spread.width_px
                    variance[tag, sides] = gain * spread.variance
    return _intersect(quads, lines, inward), _corner_covariances(quads, lines, variance)


def _directions(quads: Quads) -> tuple[Quads, Quads, Sides]:
    """Unit vector along each side, outward normal, length [px]; side i runs from corner i to corner i + 1."""
    along = np.roll(quads, -1, axis=1) - quads
    lengths = np.linalg.norm(along, axis=2)
    with np.errstate(all="ignore"):
        along = along / lengths[:, :, None]
    return along, np.stack([along[:, :, 1], -along[:, :, 0]], axis=2), lengths


def _cell_depths(quads: Quads, cells: int) -> Sides:
    """Size of a cell across each side [px]: the nearer opposite corner's distance over the number of cells."""
    _, normals, _ = _directions(quads)
    inward = [
        np.abs(((np.roll(quads, -k, axis=1) - quads) * normals).sum(axis=2))  # corners i + 2 and i + 3
        for k in (2, 3)
    ]
    return np.minimum(*inward) / cells


def _find_edges(values: np.ndarray, quads: Quads, half_widths: Sides) -> _Edges:
    along, normals, lengths = _directions(quads)
    margins = np.clip(END_MARGIN * lengths, np.minimum(MIN_MARGIN_PX, 0.25 * lengths), None)
    fractions = np.linspace(-1.0, 1.0, STATIONS)
    t = (0.5 * lengths - margins)[:, :, None] * fractions
    s = half_widths[:, :, None] * np.linspace(-1.0, 1.0, SAMPLES)
    middles = 0.5 * (quads + np.roll(quads, -1, axis=1))
    points = (
        middles[:, :, None, None]
        + t[:, :, :, None, None] * along[:, :, None, None]
        + s[:, :, None, :, None] * normals[:, :, None, None]
    )
    profiles = bilinear(values, points)
    dark, bright = _plateaus(profiles)
    smoothed = smooth(profiles, s, np.minimum(SMOOTHING_PX, half_widths / 3.0))
    offset = level_crossing(smoothed, s[:, :, None], 0.5 * (dark + bright))
    contrast = bright - dark
    with np.errstate(invalid="ignore"):
        clear = contrast >= np.maximum(MIN_CONTRAST, 0.4 * _median(contrast)[:, :, None])
    offset[~clear] = np.nan
    blur, tone = _shape(smoothed, s, dark, bright)
    level = _median(0.5 * (dark + bright).reshape(len(quads), 4 * STATIONS))
    return _Edges(along=t, offset=offset, blur=blur, level=level, tone=tone)


def _plateaus(profiles: Profiles) -> tuple[np.ndarray, np.ndarray]:
    """Grey value inside and outside of the edge at each station, (t, 4, m): medians of the profile's ends."""
    ends = SAMPLES // 6
    return np.median(profiles[..., :ends], axis=-1), np.median(profiles[..., -ends:], axis=-1)


def _shape(profiles: Profiles, s: np.ndarray, dark: np.ndarray, bright: np.ndarray) -> tuple[Sides, Sides]:
    """Blur and tone of each side from its median profile."""
    levels = [dark + share * (bright - dark) for share in (0.25, 0.5, 0.75)]
    levels.append(_light_half(dark, bright))
    quarter, half, three_quarters, light = (_median(level_crossing(profiles, s[:, :, None], level)) for level in levels)
    return three_quarters - quarter, light - half


def _light_half(dark: np.ndarray, bright: np.ndarray) -> np.ndarray:
    """The pixel value of half the light between two pixel values, if the camera encodes as sRGB (IEC 61966-2-1)."""
    light = 0.5 * (_to_light(dark) + _to_light(bright))
    return 255.0 * np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1.0 / 2.4) - 0.055)


def _to_light(value: np.ndarray) -> np.ndarray:
    v = np.clip(value, 0.0, 255.0) / 255.0
    return np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)


def _median(values: np.ndarray) -> np.ndarray:
    """Median over the last axis without NaN; NaN where there is nothing else."""
    masked = np.ma.masked_invalid(values)
    return np.ma.filled(np.ma.median(masked, axis=-1).astype(np.float64), np.nan)


def _intersect(quads: Quads, lines: Lines, inward: Sides | float = 0.0) -> Quads:
    """Corner i from sides i - 1 and i moved inward [px], docs/fiducials.md eq. (2); NaN where they are parallel."""
    along, normals, _ = _directions(quads)
    middles = 0.5 * (quads + np.roll(quads, -1, axis=1))
    points = middles + (lines.offset - inward)[:, :, None] * normals
    # A line offset + slope * t turns its normal by the slope.
    turned = normals - lines.slope[:, :, None] * along
    distance = (turned * points).sum(axis=2)
    N = np.stack([np.roll(turned, 1, axis=1), turned], axis=2)
    d = np.stack([np.roll(distance, 1, axis=1), distance], axis=2)
    determinant = N[..., 0, 0] * N[..., 1, 1] - N[..., 0, 1] * N[..., 1, 0]
    with np.errstate(all="ignore"):
        x = (N[..., 1, 1] * d[..., 0] - N[..., 0, 1] * d[..., 1]) / determinant
        y = (N[..., 0, 0] * d[..., 1] - N[..., 1, 0] * d[..., 0]) / determinant
    corners = np.stack([x, y], axis=2)
    return np.where(np.expand_dims(np.abs(determinant) > MIN_SINE, 2), corners, np.nan)


def _corner_covariances(quads: Quads, lines: Lines, variance: Sides) -> QuadCovariances:
    """S = N^-1 diag(v) N^-T with the variances v of both lines at the corner, docs/fiducials.md eq. (4)-(5)."""
    _, normals, lengths = _directions(quads)
    before = np.roll(np.arange(4), 1)
    ends = (lines.variance_at(0.5 * lengths)[:, before], lines.variance_at(-0.5 * lengths))
    v = np.stack([ends[0] + variance[:, before], ends[1] + variance], axis=2)
    N = np.stack([normals[:, before], normals], axis=2)
    finite = np.expand_dims(np.isfinite(N).all(axis=(2, 3)) & np.isfinite(v).all(axis=2), (2, 3))
    inverse = np.linalg.inv(np.where(finite, N, np.eye(2)))
    S = (inverse * v[:, :, None, :]) @ inverse.swapaxes(-1, -2)
    return np.where(finite, S, np.nan)
