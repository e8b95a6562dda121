# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The flights that are rendered by name: where camera and target are at each stamp. docs/rendering.md section 7.

Any other list of `Placed` is rendered as well, for example one made from a truth.csv.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from fairlead import geometry
from fairlead.render.viewpoints import direction, look_at
from fairlead.types import Matrix4, Points3, Target, TruthPose, Vector3

RATE_HZ = 25.0
"""Of the camera; sequences are rendered at a stride of it."""
SHIP_SPEED_M_S = 9.0
ELEVATION_DEG = 15.0
FRIGATE_M = 143.5
"""Diagonal of the frigate's landmarks: other targets in space are flown at in proportion to theirs."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Placed:
    """Camera and target at one time. The world's z is up, its sea level 0."""

    frame: int
    stamp_ns: int
    T_camera_target: Matrix4
    T_world_target: Matrix4


@dataclass(frozen=True, kw_only=True, eq=False)
class Path:
    """A curve of the camera about the target's middle, run through at constant speed."""

    points: Callable[[np.ndarray], Points3]
    """Share of the way 0..1 (k,) -> camera, relative to the middle [m] (k, 3)."""
    speed_m_s: float


def _orbit(range_m: float) -> Path:
    """An arc of 90 degrees, symmetric about dead astern, at 60 m/s."""

    def points(share: np.ndarray) -> Points3:
        azimuths = np.pi + np.radians(45.0 - 90.0 * share)
        return range_m * np.stack([direction(a, np.radians(ELEVATION_DEG)) for a in azimuths])

    return Path(points=points, speed_m_s=60.0)


def _rendezvous(angle_deg: float) -> Path:
    """From 2 km to 0.5 km at 40 m/s while the azimuth turns by `angle_deg` about dead astern."""

    def points(share: np.ndarray) -> Points3:
        azimuths = np.pi + np.radians(angle_deg) * (0.5 - share)
        ranges = 2000.0 - 1500.0 * share
        return np.stack([r * direction(a, np.radians(ELEVATION_DEG)) for r, a in zip(ranges, azimuths, strict=True)])

    return Path(points=points, speed_m_s=40.0)


def _landing() -> Path:
    """Down a glide path of 8 degrees from astern, 20 m/s, from 700 m to 50 m; it ends over the touchdown point."""

    def points(share: np.ndarray) -> Points3:
        ranges = 700.0 - 650.0 * share
        return ranges[:, None] * direction(np.pi - 0.08, np.radians(8.0))

    return Path(points=points, speed_m_s=20.0)


FLIGHTS: dict[str, Callable[[], Path]] = {
    "orbit-2.0": lambda: _orbit(2000.0),
    "rendezvous-10": lambda: _rendezvous(10.0),
    "rendezvous-20": lambda: _rendezvous(20.0),
    "rendezvous-30": lambda: _rendezvous(30.0),
    "landing": _landing,
}


@dataclass(frozen=True, kw_only=True)
class Swell:
    """Heave, roll and pitch of a floating target, each one sine: amplitude and period [m, rad, s]."""

    heave: tuple[float, float] = (0.6, 8.1)
    roll: tuple[float, float] = (0.035, 10.3)
    pitch: tuple[float, float] = (0.010, 7.0)

    def at(self, time_s: float) -> Matrix4:
        """T_level_target: the moving target in axes that stay level."""
        heave, roll, pitch = (a * np.sin(2.0 * np.pi * time_s / p) for a, p in (self.heave, self.roll, self.pitch))
        return geometry.exp_se3(np.array([0.0, 0.0, heave, roll, pitch, 0.0]))


def fly(name: str, target: Target, *, stride: int, scale: float = 1.0, swell: Swell | None = None) -> list[Placed]:
    """The named flight about the middle of the target's landmarks; lengths and speed times `scale`.

    Raises ValueError for another name or a stride below 1.
    """
    if name not in FLIGHTS or stride < 1:
        raise ValueError(
            f"flight: expected one of {', '.join(FLIGHTS)} and a stride of at least 1, got {name}, {stride}"
        )
    path = FLIGHTS[name]()
    low, high = target.positions.min(axis=0), target.positions.max(axis=0)
    middle = 0.5 * (low + high)
    touchdown = middle if target.touchdown is None else target.touchdown
    shares, seconds = _even(path)
    count = int(seconds * RATE_HZ) // stride + 1
    frames = stride * np.arange(count)
    along = np.interp(frames / RATE_HZ, np.linspace(0.0, seconds, len(shares)), shares)
    centres = scale * path.points(along)
    landing = name == "landing"
    origin = touchdown if landing else middle
    aims = _aims(landing, along, middle, touchdown)
    placed: list[Placed] = []
    for frame, centre, aim in zip(frames.tolist(), centres, aims, strict=True):
        time_s = frame / RATE_HZ
        T_camera_level = look_at((origin + centre)[None], aim)[0]
        T_level_target = np.eye(4) if swell is None else swell.at(time_s)
        placed.append(
            Placed(
                frame=frame,
                stamp_ns=round(time_s * 1e9),
                T_camera_target=T_camera_level @ T_level_target,
                T_world_target=under_way(time_s) @ T_level_target,
            )
        )
    return placed


def under_way(time_s: float, speed_m_s: float = SHIP_SPEED_M_S) -> Matrix4:
    """T_world_target of a target that goes straight ahead along x."""
    T = np.eye(4)
    T[0, 3] = speed_m_s * time_s
    return T


def placed_from_truth(poses: Iterable[TruthPose]) -> list[Placed]:
    """Poses of any source; the target is upright, under way, and its clock starts with the first stamp."""
    listed = list(poses)
    first = listed[0].stamp_ns if listed else 0
    return [
        Placed(
            frame=each.frame,
            stamp_ns=each.stamp_ns,
            T_camera_target=each.T_camera_target,
            T_world_target=under_way((each.stamp_ns - first) * 1e-9),
        )
        for each in listed
    ]


def _even(path: Path) -> tuple[np.ndarray, float]:
    """Shares of the way at equal lengths, and how long the whole takes [s]."""
    shares = np.linspace(0.0, 1.0, 2001)
    steps = np.linalg.norm(np.diff(path.points(shares), axis=0), axis=1)
    lengths = np.concatenate([[0.0], np.cumsum(steps)])
    return np.interp(np.linspace(0.0, lengths[-1], 2001), lengths, shares), float(lengths[-1] / path.speed_m_s)


def _aims(landing: bool, along: np.ndarray, middle: Vector3, touchdown: Vector3) -> Points3:  # noqa: FBT001
    """Where the camera looks: the middle; in a landing the gaze wanders to the touchdown point."""
    share = np.clip((along - 0.3) / 0.6, 0.0, 1.0)[:, None] if landing else np.zeros((len(along), 1))
    return middle + share * (touchdown - middle)
