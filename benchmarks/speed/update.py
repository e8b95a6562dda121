# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Time of one `update()` with a full window, next to what a user of GTSAM would do once per frame."""

import os
import subprocess
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.speed.problem import PRIOR_SIGMA_M, SEED, SIGMA_PX, frigate
from benchmarks.speed.programs import ONE_THREAD
from fairlead.baselines.epnp import EpnpTracker
from fairlead.simulate import ModelError, ObservationError, OrbitScenario, orbit_told, orbit_views
from fairlead.tracker import Tracker
from fairlead.types import Camera, Target, View

KEYFRAMES = 64
"""Views in the window of everybody."""
WINDOWS = (KEYFRAMES, 256)
"""Views in the window of ours: as the peers', and the default. Frames before it is full are not counted."""
PEER_FRAMES = 32
REPEATS = 5


@dataclass(frozen=True, kw_only=True, eq=False)
class Flight:
    """Frames at 25 Hz round the frigate at 1 km, and the rough model that is told."""

    target: Target
    camera: Camera
    views: tuple[View, ...]

    def write(self, path: Path) -> None:
        """For update.cpp: n, frames, fx, fy, cx, cy, two sigmas, X0, then stamp and pixels of each frame; float64."""
        K = self.camera.K
        sizes = [len(self.target.landmarks), len(self.views)]
        head = np.array([*sizes, K[0, 0], K[1, 1], K[0, 2], K[1, 2], SIGMA_PX, PRIOR_SIGMA_M])
        rows = [np.concatenate([[view.stamp_ns], view.pixels.ravel()]) for view in self.views]
        arrays = [head, self.target.positions, *rows]
        path.write_bytes(b"".join(np.ascontiguousarray(a, dtype="<f8").tobytes() for a in arrays))


def make_flight(frames: int, outlier_fraction: float = 0.0) -> Flight:
    """All 20 landmarks in every frame; 1 px of noise; 1 m per coordinate of the model."""
    target, camera = frigate()
    scenario = OrbitScenario(
        frames=frames,
        model=ModelError(sigma_m=PRIOR_SIGMA_M),
        observation=ObservationError(sigma_px=SIGMA_PX, outlier_fraction=outlier_fraction),
    )
    rng = np.random.default_rng([SEED, frames])
    told = orbit_told(target, scenario, rng)
    return Flight(target=told, camera=camera, views=tuple(orbit_views(target, camera, scenario, rng)))


def core_times(program: Path, flight: Flight, max_views: int, repeats: int = REPEATS) -> tuple[int, np.ndarray]:
    """The first frame that met a full window, and the seconds of each C++ update() from there on.

    Per frame the median over repeats of the same flight; a neighbour does not count. Raises RuntimeError if a frame
    went without a pose, or the window never filled: a time without a result is none.
    """
    with tempfile.TemporaryDirectory() as folder:
        source, times = Path(folder) / "flight.bin", Path(folder) / "times.bin"
        flight.write(source)
        command = [program, source, times, str(repeats), str(max_views)]
        done = subprocess.run(command, capture_output=True, text=True, check=True, env={**os.environ, **ONE_THREAD})
        without_pose, full = map(int, done.stdout.split())
        if without_pose or full >= len(flight.views):
            raise RuntimeError(f"update(): {without_pose} frames without a pose, window full from frame {full} on")
        return full, np.median(np.fromfile(times, dtype="<f8").reshape(repeats, -1), axis=0)[full:]


def python_times(flight: Flight, repeats: int = REPEATS) -> np.ndarray:
    """The same through `fairlead.tracker.Tracker`: names to indices, arrays in, a checked `Estimate` out."""
    rows = []
    for _ in range(repeats):
        tracker, row = Tracker(flight.target, flight.camera), []
        for view in flight.views:
            begin = time.process_time()
            tracker.update(view)
            row.append(time.process_time() - begin)
        rows.append(row)
    return np.median(np.array(rows), axis=0)


class GtsamFrames:
    """Keys, factors and starts of one frame after the other: EPnP on the told model, and the told landmarks."""

    def __init__(self, flight: Flight) -> None:
        import gtsam

        self.gtsam = gtsam
        self._flight = flight
        self._epnp = EpnpTracker(flight.target, flight.camera)
        K = flight.camera.K
        self._intrinsics = gtsam.Cal3_S2(K[0, 0], K[1, 1], 0.0, K[0, 2], K[1, 2])
        self._pixel = gtsam.noiseModel.Isotropic.Sigma(2, SIGMA_PX)
        self._prior = gtsam.noiseModel.Isotropic.Sigma(3, PRIOR_SIGMA_M)
        self.points = [gtsam.symbol("l", j) for j in range(len(flight.target.landmarks))]

    def add_prior(self, graph: Any) -> None:
        for j, X in zip(self.points, self._flight.target.positions, strict=True):
            graph.add(self.gtsam.PriorFactorPoint3(j, X, self._prior))

    def add_landmarks(self, values: Any) -> None:
        for j, X in zip(self.points, self._flight.target.positions, strict=True):
            values.insert(j, X)

    def key(self, frame: int) -> int:
        return self.gtsam.symbol("x", frame)

    def add_view(self, graph: Any, frame: int) -> None:
        for j, z in zip(self.points, self._flight.views[frame].pixels, strict=True):
            graph.add(self.gtsam.GenericProjectionFactorCal3_S2(z, self._pixel, self.key(frame), j, self._intrinsics))

    def start(self, frame: int) -> Any:
        T = self._epnp.update(self._flight.views[frame]).T_camera_target
        return self.gtsam.Pose3(np.linalg.inv(T))


def isam2_times(flight: Flight) -> np.ndarray:
    """iSAM2, default options: seconds of update() and of the new pose, at 64 to 96 poses; nothing is marginalised."""
    frames = GtsamFrames(flight)
    gtsam = frames.gtsam
    isam, seconds = gtsam.ISAM2(gtsam.ISAM2Params()), []
    for frame in range(KEYFRAMES + PEER_FRAMES):
        graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        if frame == 0:
            frames.add_prior(graph)
            frames.add_landmarks(values)
        frames.add_view(graph, frame)
        values.insert(frames.key(frame), frames.start(frame))
        begin = time.process_time()
        isam.update(graph, values)
        isam.calculateEstimatePose3(frames.key(frame))
        seconds.append(time.process_time() - begin)
    return np.array(seconds[KEYFRAMES:])


def window_times(flight: Flight) -> np.ndarray:
    """All of a sliding window of 64 views solved again by Levenberg-Marquardt, poses first, GTSAM's own tolerance 1e-5.

    Started from the last solution; the views that left are forgotten, which is cheaper than marginalising them.
    """
    frames = GtsamFrames(flight)
    gtsam = frames.gtsam
    values, seconds = gtsam.Values(), []
    frames.add_landmarks(values)
    for frame in range(KEYFRAMES):
        values.insert(frames.key(frame), frames.start(frame))
    for last in range(KEYFRAMES - 1, KEYFRAMES - 1 + PEER_FRAMES):
        kept = range(last - KEYFRAMES + 1, last + 1)
        graph, ordering = gtsam.NonlinearFactorGraph(), gtsam.Ordering()
        frames.add_prior(graph)
        for frame in kept:
            frames.add_view(graph, frame)
        for key in (*map(frames.key, kept), *frames.points):
            ordering.push_back(key)
        parameters = gtsam.LevenbergMarquardtParams.LegacyDefaults()
        parameters.setOrdering(ordering)
        begin = time.process_time()
        values = gtsam.LevenbergMarquardtOptimizer(graph, values, parameters).optimize()
        seconds.append(time.process_time() - begin)
        values.erase(frames.key(kept[0]))
        values.insert(frames.key(last + 1), frames.start(last + 1))
    return np.array(seconds[1:])


def describe(name: str, seconds: np.ndarray, frames: str) -> dict[str, Any]:
    """One row of the table."""
    ms = 1e3 * seconds
    return {
        "name": name,
        "frames": frames,
        "p50_ms": float(np.percentile(ms, 50)),
        "p99_ms": float(np.percentile(ms, 99)),
        "max_ms": float(ms.max()),
    }


def measure_updates(programs: dict[str, Path], frames: int, say: Callable[[str], None]) -> list[dict[str, Any]]:
    """Rows of the table. `programs` are the folders that `build_core` made, by name."""
    rows = []
    for data, fraction in (("", 0.0), (", 10 % outliers", 0.1)):
        flight = make_flight(frames, fraction)
        for name, folder in programs.items():
            for max_views in WINDOWS:
                say(f"update(): C++ {name}, window of {max_views}{data}")
                full, seconds = core_times(folder / "update", flight, max_views)
                label = f"fairlead, C++ {name}, window of {max_views}{data}"
                rows.append(describe(label, seconds, f"{full} to {frames}"))
        if not fraction:
            say("update(): through Python")
            seconds = python_times(flight)[WINDOWS[-1] :]
            rows.append(describe("fairlead, Python, window of 256", seconds, f"{WINDOWS[-1]} to {frames}"))
    try:
        short = replace(make_flight(KEYFRAMES + PEER_FRAMES + 1))
        for name, measure in (("GTSAM, iSAM2", isam2_times), ("GTSAM, window of 64 solved again", window_times)):
            say(f"update(): {name}")
            rows.append(describe(name, measure(short), f"{KEYFRAMES} to {KEYFRAMES + PEER_FRAMES}"))
    except ImportError:
        say("GTSAM is not installed: left out")
    return rows
