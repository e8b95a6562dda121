# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Draw one flight of a scenario: the truth, and what sensors say of it. docs/simulate.md eq. (1)-(30)."""

import itertools
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from fairlead.simulate.frames import Exposures
from fairlead.simulate.limits import expect
from fairlead.simulate.mistakes import ImagePoints
from fairlead.simulate.recorded import Recorded
from fairlead.simulate.rotations import Times, motions
from fairlead.simulate.scenario import Scenario
from fairlead.simulate.sensors import reading_times
from fairlead.simulate.streams import Seed, Streams
from fairlead.simulate.told import draw_targets
from fairlead.simulate.trajectory import look_at
from fairlead.simulate.truth import Simulation, project_all
from fairlead.simulate.visibility import Centres, Seen, in_image, incidence, named_normals
from fairlead.types import AttitudeReading, Points3, Poses, RangeReading, Target, View

MAX_OBSERVATIONS = 10_000_000
"""Images times landmarks of one flight: all are drawn at once, in about 2 GB."""


def simulate(scenario: Scenario, seed: Seed) -> Simulation:
    """One flight. The same scenario and seed give the same bits; each effect has a stream of its own.

    Raises ValueError where the scenario cannot be flown, such as a camera straight above what it looks at.
    """
    streams = Streams(seed)
    true, told = draw_targets(scenario, streams)
    world = World(scenario, streams)
    turns = scenario.frames.turns(scenario.trajectory)
    size = len(turns) * len(true.landmarks)
    expect("frames", size, f"at most {MAX_OBSERVATIONS} images times landmarks", when=size <= MAX_OBSERVATIONS)
    exposures = scenario.frames.draw(turns, streams)
    T = world.T_camera_target(exposures.t_s)
    detections = detect(scenario, true, turns, T, streams)
    return Simulation(
        camera=scenario.camera,
        target_told=told,
        views=detections.views(true.landmarks, exposures),
        target_true=true,
        T_true=T[exposures.kept],
        ranges=_ranges(scenario, true, world, exposures, streams),
        attitudes=_attitudes(scenario, world, exposures, streams),
    )


class World:
    """Where the camera and the target are at any time. Draws what shakes and sways."""

    def __init__(self, scenario: Scenario, streams: Streams) -> None:
        self._path = scenario.trajectory
        self._point = scenario.pointing.point(scenario.target)
        self._turning = scenario.shake.turning(streams)
        self._swaying = scenario.shake.swaying(streams)
        motion = scenario.target_motion
        self._T_world_target = motion.draw(scenario.target, streams) if motion.moves else None

    def T_camera_world(self, t_s: Times) -> Poses:
        """Eq. (3) and (4)."""
        centres = self._path.centres(t_s)
        if self._swaying is not None:
            centres = centres + self._swaying(t_s)
        T = self._steady(t_s, centres)
        if self._turning is not None:
            T[:, :3] = self._turning(t_s) @ T[:, :3]
        return T

    def _steady(self, t_s: Times, centres: Points3) -> Poses:
        if not isinstance(self._path, Recorded):
            return look_at(centres, self._point)
        R = self._path.R_world_camera(t_s).transpose(0, 2, 1)
        return motions(R, -np.einsum("kij,kj->ki", R, centres))

    def T_camera_target(self, t_s: Times) -> Poses:
        """Eq. (8)."""
        T = self.T_camera_world(t_s)
        return T if self._T_world_target is None else T @ self._T_world_target(t_s)


@dataclass(frozen=True, kw_only=True, eq=False)
class Detections:
    """What the detector finds in every image that is due."""

    pixels: ImagePoints
    told_sigmas: Float64[np.ndarray, "k n"]
    found: Seen

    def views(self, landmarks: tuple[str, ...], exposures: Exposures) -> tuple[View, ...]:
        """The images that arrive."""
        covariances = self.told_sigmas[..., None, None] ** 2 * np.eye(2)
        views: list[View] = []
        for k in np.flatnonzero(exposures.kept).tolist():
            found: list[bool] = self.found[k].tolist()
            rows = slice(None) if all(found) else np.flatnonzero(found)
            names = landmarks if all(found) else tuple(itertools.compress(landmarks, found))
            views.append(
                View(
                    frame=k,
                    stamp_ns=int(exposures.stamps_ns[k]),
                    landmarks=names,
                    pixels=self.pixels[k, rows],
                    covariances=covariances[k, rows],
                )
            )
        return tuple(views)


def detect(scenario: Scenario, true: Target, turns: Times, T_camera_target: Poses, streams: Streams) -> Detections:
    """Eq. (16)-(25): what is in sight, where it is found, what is missed, mistaken or wrong."""
    X = scenario.noise.found_instead(true.positions, streams)
    pixels_true = project_all(scenario.camera, X, T_camera_target)
    centres = -np.einsum("kji,kj->ki", T_camera_target[:, :3, :3], T_camera_target[:, :3, 3])
    found = in_image(scenario.camera, pixels_true) & scenario.occlusion.visible(true, scenario.normals, centres)
    missed = scenario.dropout.missed(turns, len(X), streams)
    found = found if missed is None else found & ~missed
    sigmas = _sigmas(scenario, true, centres)
    pixels = pixels_true + scenario.noise.draw(turns, centres - true.positions.mean(axis=0), sigmas, streams)
    pixels = scenario.outliers.spoil(pixels, turns, scenario.camera, streams)
    told_sigmas = scenario.noise.told_sigmas(sigmas)
    order = scenario.swaps.order(true, pixels_true, turns, streams)
    if order is not None:
        pixels = np.take_along_axis(pixels, order[..., None], axis=1)
        told_sigmas = np.take_along_axis(told_sigmas, order, axis=1)
        found = np.take_along_axis(found, order, axis=1)
    return Detections(pixels=pixels, told_sigmas=told_sigmas, found=found)


def _sigmas(scenario: Scenario, true: Target, centres: Centres) -> Float64[np.ndarray, "k n"]:
    """Eq. (21)."""
    X = true.positions
    if scenario.noise.uniform:
        return np.full((len(centres), len(X)), scenario.noise.sigma_px)
    normals = named_normals(true, scenario.normals)
    outward = X - X.mean(axis=0)
    outward /= np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1e-12)
    cosines = incidence(X, np.where(np.isnan(normals), outward, normals), centres)
    return scenario.noise.sigmas(np.linalg.norm(centres[:, None] - X, axis=2), cosines)


def _ranges(
    scenario: Scenario, true: Target, world: World, exposures: Exposures, streams: Streams
) -> tuple[RangeReading, ...]:
    readings: list[RangeReading] = []
    for index, finder in enumerate(scenario.range):
        t_s = reading_times(finder.rate_hz, exposures.t_s, scenario.trajectory.length_s)
        X = np.zeros(3) if finder.landmark is None else true.positions[true.landmarks.index(finder.landmark)]
        T = world.T_camera_target(t_s)
        points: Points3 = T[:, :3, :3] @ X + T[:, :3, 3]
        readings += finder.read(t_s, points, streams, index)
    return tuple(sorted(readings, key=lambda reading: reading.stamp_ns))


def _attitudes(scenario: Scenario, world: World, exposures: Exposures, streams: Streams) -> tuple[AttitudeReading, ...]:
    if scenario.attitude is None:
        return ()
    t_s = reading_times(scenario.attitude.rate_hz, exposures.t_s, scenario.trajectory.length_s)
    R_world_camera = world.T_camera_world(t_s)[:, :3, :3].transpose(0, 2, 1)
    return tuple(scenario.attitude.read(t_s, R_world_camera, streams))
