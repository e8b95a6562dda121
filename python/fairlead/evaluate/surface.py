# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Errors of a whole surface: ADD, MSSD, MSPD as the BOP benchmark defines them, docs/metrics.md eq. (14)-(17).

Sources: Hinterstoisser et al. 2012 (ADD); Hodan et al. 2020, BOP Challenge 2020, section 2.2 (MSSD, MSPD, recalls).
Targets without symmetries only.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fairlead import geometry
from fairlead.evaluate.summary import Series, Summary, summarise
from fairlead.types import Camera, Matrix4, Points3, Poses

ADD_LIMIT = 0.1
"""A pose is right in the sense of ADD below this share of the diameter [-]."""
MSSD_LIMITS = tuple(np.linspace(0.05, 0.5, 10).tolist())
"""Shares of the diameter over which the recall of MSSD is averaged [-]."""
MSPD_LIMITS_PX = tuple(np.linspace(5.0, 50.0, 10).tolist())
"""Limits over which the recall of MSPD is averaged, for an image 640 px wide [px]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SurfaceErrors:
    """Per judged frame: NaN where there is no pose. The recalls count such a frame as missed."""

    diameter_m: float
    add_m: Series
    mssd_m: Series
    mspd_px: Series | None
    """None without a camera; inf where a vertex falls behind it."""
    add_summary: Summary
    mssd_summary: Summary
    mspd_summary: Summary | None
    add_recall: float
    """Share of frames with ADD below a tenth of the diameter [-]."""
    mssd_recall: float
    """Mean share over ten limits, 5 to 50 % of the diameter [-]."""
    mspd_recall: float | None
    """Mean share over ten limits, 5 to 50 px at a width of 640 px [-]."""


def load_vertices(path: Path) -> Points3:
    """Vertices of a mesh file [m]. Raises ValueError: one line, where it cannot be read or holds no surface."""
    import trimesh

    try:
        mesh = trimesh.load(path, force="mesh", process=False)
        vertices = np.asarray(mesh.vertices, dtype=np.float64)  # pyright: ignore[reportAttributeAccessIssue]
    except Exception as error:  # any loader of trimesh may raise what it likes on a broken file
        first_line = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ValueError(f"{path}: no readable mesh: {first_line}") from error
    if not len(vertices) or not np.isfinite(vertices).all():
        raise ValueError(f"{path}: expected finite vertices, got {len(vertices)} of which some are not finite")
    return vertices


def diameter(vertices: Points3) -> float:
    """Largest distance of two vertices [m]; it is attained on the convex hull."""
    from scipy.spatial import ConvexHull, QhullError
    from scipy.spatial.distance import pdist

    corners = vertices
    if len(vertices) > 4:
        try:
            corners = vertices[ConvexHull(vertices).vertices]
        except QhullError:  # flat or straight: there is no hull of positive volume
            corners = np.unique(vertices, axis=0)
    return float(pdist(corners).max(initial=0.0))


def average_distance(T_estimated: Matrix4, T_true: Matrix4, vertices: Points3) -> float:
    """ADD = mean |T_est v - T_true v| [m], docs/metrics.md eq. (14)."""
    return float(_distances(T_estimated, T_true, vertices).mean())


def maximum_distance(T_estimated: Matrix4, T_true: Matrix4, vertices: Points3) -> float:
    """MSSD without symmetries = max |T_est v - T_true v| [m], docs/metrics.md eq. (15)."""
    return float(_distances(T_estimated, T_true, vertices).max())


def maximum_projected_distance(T_estimated: Matrix4, T_true: Matrix4, vertices: Points3, camera: Camera) -> float:
    """MSPD without symmetries = max |pi(T_est v) - pi(T_true v)| [px], docs/metrics.md eq. (16).

    Over the vertices that the true pose can project; inf where the estimate cannot project one of them.
    """
    z_true = geometry.project(camera, geometry.transform(T_true, vertices))
    seen = np.isfinite(z_true).all(axis=1)
    z = geometry.project(camera, geometry.transform(T_estimated, vertices[seen]))
    distances = np.linalg.norm(z - z_true[seen], axis=1)
    if not distances.size:
        return float("nan")
    return float("inf") if np.isnan(distances).any() else float(distances.max())


def surface_errors(T_estimated: Poses, T_true: Poses, vertices: Points3, camera: Camera | None) -> SurfaceErrors:
    """All three errors of every judged frame with their recalls, docs/metrics.md eq. (14)-(17)."""
    size = diameter(vertices)
    rows = range(len(T_true))
    has_pose: list[bool] = [bool(np.isfinite(T).all()) for T in T_estimated]
    add = [average_distance(T_estimated[k], T_true[k], vertices) if has_pose[k] else np.nan for k in rows]
    mssd = [maximum_distance(T_estimated[k], T_true[k], vertices) if has_pose[k] else np.nan for k in rows]
    mspd: Series | None = None
    if camera is not None:
        each = [
            maximum_projected_distance(T_estimated[k], T_true[k], vertices, camera) if has_pose[k] else np.nan
            for k in rows
        ]
        mspd = np.array(each, dtype=np.float64)
    add_m, mssd_m = np.array(add, dtype=np.float64), np.array(mssd, dtype=np.float64)
    widths = 1.0 if camera is None else camera.width / 640.0
    return SurfaceErrors(
        diameter_m=size,
        add_m=add_m,
        mssd_m=mssd_m,
        mspd_px=mspd,
        add_summary=summarise(add_m),
        mssd_summary=summarise(mssd_m),
        mspd_summary=None if mspd is None else summarise(mspd),
        add_recall=recall(add_m, (ADD_LIMIT * size,)),
        mssd_recall=recall(mssd_m, tuple(limit * size for limit in MSSD_LIMITS)),
        mspd_recall=None if mspd is None else recall(mspd, tuple(limit * widths for limit in MSPD_LIMITS_PX)),
    )


def recall(errors: Series, limits: tuple[float, ...]) -> float:
    """Mean over the limits of the share of frames below each; NaN counts as missed, docs/metrics.md eq. (17)."""
    if not errors.size:
        return float("nan")
    return float(np.mean([np.mean(errors < limit) for limit in limits]))


def _distances(T_estimated: Matrix4, T_true: Matrix4, vertices: Points3) -> Series:
    return np.linalg.norm(vertices @ (T_estimated - T_true)[:3, :3].T + (T_estimated - T_true)[:3, 3], axis=1)
