# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The one problem that every solver gets: cost, data and start, and the one function that judges what they return."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fairlead.baselines.epnp import EpnpTracker
from fairlead.io.camera import load_camera
from fairlead.io.target import load_target
from fairlead.simulate import ArcScenario, ModelError, ObservationError, project_all, simulate_arc
from fairlead.types import Camera, Points3, Poses, Target

FRIGATE = Path(__file__).resolve().parents[2] / "data" / "frigate"
SEED = 20_107
ANGLE_DEG = 90.0
SIGMA_PX = 1.0
PRIOR_SIGMA_M = 1.0


@dataclass(frozen=True, kw_only=True, eq=False)
class WindowProblem:
    """E(X, T) = 1/2 [sum_kj |pi(T_k X_j) - z_kj|^2 / sigma_px^2 + |X - X0|^2 / prior_sigma_m^2], least squares.

    Every view sees every landmark. X0 is told and is where the landmarks start; T_start is EPnP of each view on X0.
    """

    camera: Camera
    X0: Points3
    """(n, 3) [m]."""
    T_start: Poses
    """(k, 4, 4) T_camera_target."""
    pixels: np.ndarray
    """(k, n, 2) [px]."""
    sigma_px: float = SIGMA_PX
    prior_sigma_m: float = PRIOR_SIGMA_M

    @property
    def landmarks(self) -> int:
        return len(self.X0)

    @property
    def views(self) -> int:
        return len(self.T_start)

    def cost(self, X: Points3, T_camera_target: Poses) -> float:
        """E at an answer; NaN if a landmark is behind a camera."""
        r = (project_all(self.camera, X, T_camera_target) - self.pixels) / self.sigma_px
        d = (X - self.X0) / self.prior_sigma_m
        return 0.5 * float(np.sum(r * r) + np.sum(d * d))

    def write(self, path: Path) -> None:
        """For the C++ programs, problem_file.hpp: float64, little-endian.

        n, k, fx, fy, cx, cy, sigma_px, prior_sigma_m, X0 (n, 3), R (row-major) and t of each view (k, 12),
        pixels (k, n, 2).
        """
        K = self.camera.K
        head = [self.landmarks, self.views, K[0, 0], K[1, 1], K[0, 2], K[1, 2], self.sigma_px, self.prior_sigma_m]
        poses = np.concatenate([self.T_start[:, :3, :3].reshape(-1, 9), self.T_start[:, :3, 3]], axis=1)
        arrays = [np.array(head), self.X0, poses, self.pixels]
        path.write_bytes(b"".join(np.ascontiguousarray(a, dtype="<f8").tobytes() for a in arrays))


def frigate() -> tuple[Target, Camera]:
    """The ship, and the camera without its zero distortion, which no peer would compute either."""
    camera = load_camera(FRIGATE / "camera.yaml")
    if np.any(camera.distortion):
        raise RuntimeError("the frigate's camera was expected to have no distortion")
    return load_target(FRIGATE / "target.toml"), replace(camera, model="pinhole", distortion=np.zeros(0))


def target_with(landmarks: int, rng: np.random.Generator) -> Target:
    """The frigate's 20 landmarks, and beyond these points drawn evenly from the box that they fill."""
    target, _ = frigate()
    X = target.positions
    if landmarks <= len(X):
        return replace(
            target,
            landmarks=target.landmarks[:landmarks],
            positions=X[:landmarks],
            covariance=np.eye(3 * landmarks),
            distances=(),
        )
    more = rng.uniform(X.min(axis=0), X.max(axis=0), (landmarks - len(X), 3))
    names = (*target.landmarks, *(f"point_{i}" for i in range(len(more))))
    return replace(
        target,
        landmarks=names,
        positions=np.concatenate([X, more]),
        covariance=np.eye(3 * landmarks),
        distances=(),
    )


def make_problem(views: int, landmarks: int) -> WindowProblem:
    """A quarter circle round the frigate at 1 km, 1 px of noise, a model told with 1 m per coordinate."""
    rng = np.random.default_rng([SEED, views, landmarks])
    target, camera = target_with(landmarks, rng), frigate()[1]
    scenario = ArcScenario(
        angle_deg=ANGLE_DEG,
        views=views,
        model=ModelError(sigma_m=PRIOR_SIGMA_M),
        observation=ObservationError(sigma_px=SIGMA_PX),
    )
    flight = simulate_arc(target, camera, scenario, rng)
    epnp = EpnpTracker(flight.target_told, camera)
    starts = [epnp.update(view) for view in flight.views]
    if not all(start.ok for start in starts):
        raise RuntimeError("EPnP found no start for a view of the benchmark")
    return WindowProblem(
        camera=camera,
        X0=flight.target_told.positions,
        T_start=np.stack([start.T_camera_target for start in starts]),
        pixels=np.stack([view.pixels for view in flight.views]),
    )
