# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Which landmarks can be seen, and which of these are found. docs/simulate.md eq. (16)-(18)."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float64

from fairlead.raycast import visible_from
from fairlead.simulate.limits import expect, expect_at_least_zero, expect_share
from fairlead.simulate.outages import draw_outages
from fairlead.simulate.rotations import Times
from fairlead.simulate.streams import Streams
from fairlead.types import Camera, Points3, Target

Seen = Bool[np.ndarray, "k n"]
Centres = Float64[np.ndarray, "k 3"]
Normals = Mapping[str, tuple[float, float, float]]


@dataclass(frozen=True, kw_only=True)
class Occlusion:
    """What of the target hides its own landmarks."""

    kind: Literal["none", "mesh", "normals"] = "none"
    """mesh: the target's surface. normals: a landmark is seen from the side that its normal points to."""
    tolerance_m: float | None = None
    """The surface hides nothing this near to a landmark, which lies on it; 1/300 of the size if not given [m]."""
    max_incidence_deg: float = 90.0
    """Largest angle between the normal and the direction to the camera [deg]."""

    def __post_init__(self) -> None:
        if self.tolerance_m is not None:
            expect_at_least_zero("tolerance_m", self.tolerance_m)
        expect("max_incidence_deg", self.max_incidence_deg, "0 to 180", when=0.0 <= self.max_incidence_deg <= 180.0)

    def check(self, target: Target) -> None:
        """Raises ValueError where there is no mesh to be hidden by."""
        if self.kind == "mesh" and target.mesh is None:
            raise ValueError(f"kind: expected a mesh in the target {target.name}, got none")

    def visible(self, target: Target, normals: Normals, centres: Centres) -> Seen:
        """Whether each landmark faces each camera; `centres` in the target frame. Raises ValueError for a bad mesh."""
        if self.kind == "mesh" and target.mesh is not None:
            size_m = float(np.linalg.norm(np.ptp(target.positions, axis=0)))
            tolerance_m = size_m / 300.0 if self.tolerance_m is None else self.tolerance_m
            return visible_from(target.mesh, tolerance_m, target.positions.tobytes(), centres.tobytes())
        if self.kind == "normals":
            limit = np.cos(np.radians(self.max_incidence_deg)) - 1e-12
            cosines = incidence(target.positions, named_normals(target, normals), centres)
            return ~(cosines < limit)
        return np.ones((len(centres), len(target.landmarks)), dtype=np.bool_)


def named_normals(target: Target, normals: Normals) -> Points3:
    """Unit normals in the order of the landmarks; NaN where none is given. Raises ValueError for a name not there."""
    rows = np.full((len(target.landmarks), 3), np.nan)
    for name, normal in normals.items():
        if name not in target.landmarks:
            raise ValueError(f"{name}: expected landmarks of {target.name}")
        length = float(np.linalg.norm(normal))
        expect(name, normal, "a direction, not 0 0 0", when=length > 0.0)
        rows[target.landmarks.index(name)] = np.array(normal) / length
    return rows


def incidence(X: Points3, normals: Points3, centres: Centres) -> Float64[np.ndarray, "k n"]:
    """Cosine of the angle between each normal and the direction from its landmark to the camera; NaN without normal."""
    rays = centres[:, None] - X
    return np.einsum("kni,ni->kn", rays, normals) / np.linalg.norm(rays, axis=2)


@dataclass(frozen=True, kw_only=True)
class Dropout:
    """Landmarks that are in sight and are not found."""

    share: float = 0.0
    """Of the observations, each by itself [-]."""
    burst_share: float = 0.0
    """Share of the time that each landmark is out for a while [-]."""
    burst_s: float = 1.0
    """How long such an outage is on average [s]."""
    blackout_s: tuple[tuple[float, float], ...] = ()
    """From when to when nothing is found at all [s]."""

    def __post_init__(self) -> None:
        expect_share("share", self.share)
        expect_share("burst_share", self.burst_share)
        expect_at_least_zero("burst_s", self.burst_s)
        for begin, end in self.blackout_s:
            expect("blackout_s", [begin, end], "pairs of two times, begin <= end", when=begin <= end)

    def missed(self, t_s: Times, n: int, streams: Streams) -> Seen | None:
        """Whether each observation is lost; None if none is."""
        if self.share == 0.0 and self.burst_share == 0.0 and not self.blackout_s:
            return None
        missed = np.zeros((len(t_s), n), dtype=np.bool_)
        if self.share > 0.0:
            missed |= streams.of("dropout").random(missed.shape) < self.share
        if self.burst_share > 0.0:
            missed |= draw_outages(t_s, n, self.burst_share, self.burst_s, streams.of("bursts"))
        for begin, end in self.blackout_s:
            missed[(t_s >= begin) & (t_s <= end)] = True
        return missed


def in_image(camera: Camera, pixels: Float64[np.ndarray, "k n 2"]) -> Seen:
    """Whether each point lies within the image, whose pixels reach from -0.5 to the size - 0.5."""
    with np.errstate(invalid="ignore"):
        inside = (pixels >= -0.5) & (pixels <= np.array([camera.width, camera.height]) - 0.5)
    return inside[..., 0] & inside[..., 1]
