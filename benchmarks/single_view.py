# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Pose of an exactly known target from one view: the core, OpenCV and PoseLib on the same random tasks.

    python -m benchmarks.single_view [--trials 500]

Prints the tables of docs/pnp.md section 5. A pose counts as found if it is within 5 degrees and 5 % of the range.
"""

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
import poselib

from fairlead import _core, geometry

FOCAL_PX = 1000.0
CENTRE_PX = 511.5
SIZE_PX = 1024
K = np.array([[FOCAL_PX, 0.0, CENTRE_PX], [0.0, FOCAL_PX, CENTRE_PX], [0.0, 0.0, 1.0]])
CAMERA = _core.Camera("pinhole", SIZE_PX, SIZE_PX, K, np.zeros(0))
POSELIB_CAMERA = {
    "model": "PINHOLE",
    "width": SIZE_PX,
    "height": SIZE_PX,
    "params": [FOCAL_PX, FOCAL_PX, CENTRE_PX, CENTRE_PX],
}
SIGMA_PX = 0.5
INLIER_PX = SIGMA_PX * float(np.sqrt(9.21034037197618))
FOUND_RAD = np.deg2rad(5.0)
FOUND_RANGE = 0.05
NOTHING = (np.pi, 1.0)
"""Errors where there is no answer."""


@dataclass(frozen=True, kw_only=True)
class Setting:
    name: str
    landmarks: int
    outliers: int
    half_sides_m: tuple[float, float, float]
    range_m: float


SETTINGS = (
    Setting(name="4 landmarks", landmarks=4, outliers=0, half_sides_m=(1.0, 1.0, 1.0), range_m=8.0),
    Setting(name="10 landmarks", landmarks=10, outliers=0, half_sides_m=(1.0, 1.0, 1.0), range_m=8.0),
    Setting(name="10 landmarks, far", landmarks=10, outliers=0, half_sides_m=(1.0, 1.0, 1.0), range_m=50.0),
    Setting(name="10 landmarks in a plane", landmarks=10, outliers=0, half_sides_m=(1.0, 1.0, 0.0), range_m=8.0),
    Setting(name="20 landmarks, 30 % wrong", landmarks=20, outliers=6, half_sides_m=(1.0, 1.0, 1.0), range_m=8.0),
    Setting(name="20 landmarks, 50 % wrong", landmarks=20, outliers=10, half_sides_m=(1.0, 1.0, 1.0), range_m=8.0),
    Setting(name="long hull, 30 % wrong", landmarks=20, outliers=6, half_sides_m=(1.0, 0.13, 0.23), range_m=8.0),
)


@dataclass
class Task:
    X: np.ndarray
    T: np.ndarray
    pixels: np.ndarray


def make_task(rng: np.random.Generator, setting: Setting) -> Task:
    n = setting.landmarks
    X = rng.uniform(-1.0, 1.0, (n, 3)) * setting.half_sides_m
    T = np.eye(4)
    Q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    T[:3, :3] = Q * np.linalg.det(Q)
    T[:3, 3] = np.array([*rng.uniform(-0.1, 0.1, 2), 1.0]) * setting.range_m
    p = geometry.transform(T, X)
    pixels = FOCAL_PX * p[:, :2] / p[:, 2:] + CENTRE_PX + rng.normal(scale=SIGMA_PX, size=(n, 2))
    pixels[: setting.outliers] = rng.uniform(0.0, SIZE_PX, (setting.outliers, 2))
    return Task(X, T, pixels)


def core(task: Task) -> np.ndarray | None:
    landmarks = np.arange(len(task.X), dtype=np.int32)
    covariances = np.tile(SIGMA_PX**2 * np.eye(2), (len(task.X), 1, 1))
    pose, _, ok = _core.ransac(CAMERA, task.X, landmarks, task.pixels, covariances, max_iterations=1000)
    if not ok:
        return None
    best, _, _ = _core.pose_pair(CAMERA, pose[0], task.X, landmarks, task.pixels, covariances)
    return best[0] if best[5] else None


def pose_lib(task: Task) -> np.ndarray | None:
    options = {"max_reproj_error": INLIER_PX, "max_iterations": 1000, "min_iterations": 10, "success_prob": 0.9999}
    pose, info = poselib.estimate_absolute_pose(list(task.pixels), list(task.X), POSELIB_CAMERA, options, {})
    return np.vstack([pose.Rt, [0.0, 0.0, 0.0, 1.0]]) if info["num_inliers"] >= 4 else None


def _from_opencv(rvec: np.ndarray, tvec: np.ndarray) -> np.ndarray:
    T = np.eye(4)
    T[:3, :3] = cv2.Rodrigues(rvec)[0]
    T[:3, 3] = tvec.ravel()
    return T


def opencv_direct(flag: int) -> Callable[[Task], np.ndarray | None]:
    """A closed-form method, then Levenberg-Marquardt."""

    def solve(task: Task) -> np.ndarray | None:
        found, rvec, tvec = cv2.solvePnP(task.X, task.pixels, K, np.zeros(4), flags=flag)
        if not found or not (np.isfinite(rvec).all() and np.isfinite(tvec).all()):
            return None
        return _from_opencv(*cv2.solvePnPRefineLM(task.X, task.pixels, K, np.zeros(4), rvec, tvec))

    return solve


def opencv_ransac(task: Task) -> np.ndarray | None:
    found, rvec, tvec, inliers = cv2.solvePnPRansac(
        task.X, task.pixels, K, np.zeros(4), iterationsCount=1000, reprojectionError=INLIER_PX, confidence=0.9999
    )
    if not found or inliers is None or len(inliers) < 4:
        return None
    kept = inliers.ravel()
    return _from_opencv(*cv2.solvePnPRefineLM(task.X[kept], task.pixels[kept], K, np.zeros(4), rvec, tvec))


METHODS: dict[str, Callable[[Task], np.ndarray | None]] = {
    "fairlead": core,
    "PoseLib": pose_lib,
    "OpenCV RANSAC + LM": opencv_ransac,
    "OpenCV EPnP + LM": opencv_direct(cv2.SOLVEPNP_EPNP),
    "OpenCV SQPnP + LM": opencv_direct(cv2.SOLVEPNP_SQPNP),
}


def errors(T: np.ndarray, T_true: np.ndarray) -> tuple[float, float]:
    """Angle [rad] and distance relative to the range [-]; an answer with NaN counts as none."""
    if not np.isfinite(T).all():
        return NOTHING
    angle = float(np.linalg.norm(geometry.difference(T, T_true)[3:]))
    return angle, float(np.linalg.norm(T[:3, 3] - T_true[:3, 3]) / np.linalg.norm(T_true[:3, 3]))


def compare(trials: int) -> None:
    print("| task | method | found | median rotation [deg] | median translation [% of range] | time [ms] |")
    print("|---|---|---|---|---|---|")
    for setting in SETTINGS:
        rng = np.random.default_rng(1)
        tasks = [make_task(rng, setting) for _ in range(trials)]
        for name, solve in METHODS.items():
            if setting.outliers and ("EPnP" in name or "SQPnP" in name):
                continue
            results, times = [], []
            for task in tasks:
                start = time.perf_counter()
                T = solve(task)
                times.append(time.perf_counter() - start)
                results.append(errors(T, task.T) if T is not None else NOTHING)
            angle, shift = np.array(results).T
            found = 100.0 * np.mean((angle < FOUND_RAD) & (shift < FOUND_RANGE))
            print(
                f"| {setting.name} | {name} | {found:.1f} % | {np.rad2deg(np.median(angle)):.3f} "
                f"| {100.0 * np.median(shift):.3f} | {1e3 * np.median(times):.3f} |"
            )


def compare_p3p(trials: int) -> None:
    """Exact points: how often an answer's translation is true to 1e-6 of the range, and the median rotation error."""
    print("\n| P3P | range | true pose among the answers | median rotation error [rad] | time [us] |")
    print("|---|---|---|---|---|")
    solvers: dict[str, Callable[[np.ndarray, np.ndarray], list[np.ndarray]]] = {
        "fairlead": lambda rays, X: list(_core.p3p(rays, X)),
        "PoseLib": lambda rays, X: [np.vstack([p.Rt, [0, 0, 0, 1]]) for p in poselib.p3p(list(rays), list(X))],
    }
    for range_m in (4.0, 100.0, 10_000.0):
        setting = Setting(name="", landmarks=3, outliers=0, half_sides_m=(1.0, 1.0, 1.0), range_m=range_m)
        rng = np.random.default_rng(2)
        tasks = [make_task(rng, setting) for _ in range(trials)]
        for name, solve in solvers.items():
            best, times = [], []
            for task in tasks:
                p = geometry.transform(task.T, task.X)
                rays = p / np.linalg.norm(p, axis=1, keepdims=True)
                start = time.perf_counter()
                answers = solve(rays, task.X)
                times.append(time.perf_counter() - start)
                best.append(min((errors(T, task.T) for T in answers), default=NOTHING))
            angle, shift = np.array(best).T
            found = 100.0 * np.mean(shift < 1e-6)
            print(f"| {name} | {range_m:g} | {found:.2f} % | {np.median(angle):.1e} | {1e6 * np.median(times):.1f} |")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=500)
    trials = parser.parse_args().trials
    compare(trials)
    compare_p3p(4 * trials)


if __name__ == "__main__":
    main()
