# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Single-view poses of the core (docs/pnp.md) against OpenCV, PoseLib and SciPy."""

from dataclasses import dataclass

import cv2
import numpy as np
import pytest
from scipy.optimize import least_squares

from fairlead import _core, geometry

poselib = pytest.importorskip("poselib")

K = np.array([[1000.0, 0.0, 511.5], [0.0, 1000.0, 511.5], [0.0, 0.0, 1.0]])
CORE_CAMERA = _core.Camera("pinhole", 1024, 1024, K, np.zeros(0))
POSELIB_CAMERA = {"model": "PINHOLE", "width": 1024, "height": 1024, "params": [1000.0, 1000.0, 511.5, 511.5]}
NO_DISTORTION = np.zeros(4)


@dataclass
class Scene:
    """A target of size 1, seen once."""

    X: np.ndarray
    T: np.ndarray
    pixels: np.ndarray
    covariances: np.ndarray

    @property
    def landmarks(self) -> np.ndarray:
        return np.arange(len(self.X), dtype=np.int32)


def random_motion(rng: np.random.Generator, distance: float) -> np.ndarray:
    T = np.eye(4)
    T[:3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    T[:3, :3] *= np.linalg.det(T[:3, :3])
    T[:3, 3] = [0.1 * distance * rng.uniform(-1, 1), 0.1 * distance * rng.uniform(-1, 1), distance]
    return T


def make_scene(
    rng: np.random.Generator, n: int, sigma_px: float, box: tuple[float, float, float], distance: float
) -> Scene:
    X = rng.uniform(-1.0, 1.0, (n, 3)) * box
    T = random_motion(rng, distance)
    p = geometry.transform(T, X)
    pixels = (p @ K.T)[:, :2] / p[:, 2:] + rng.normal(scale=sigma_px, size=(n, 2))
    return Scene(X, T, pixels, np.tile(np.eye(2) * max(sigma_px, 1e-3) ** 2, (n, 1, 1)))


def refine(scene: Scene, T_start: np.ndarray, loss_threshold: float = np.inf, max_iterations: int = 50) -> tuple:
    return _core.pnp_refine(
        CORE_CAMERA, T_start, scene.X, scene.landmarks, scene.pixels, scene.covariances, loss_threshold, max_iterations
    )


def from_opencv(rvec: np.ndarray, tvec: np.ndarray) -> np.ndarray:
    T = np.eye(4)
    T[:3, :3] = cv2.Rodrigues(rvec)[0]
    T[:3, 3] = tvec.ravel()
    return T


def opencv_refined(scene: Scene, rvec: np.ndarray, tvec: np.ndarray) -> np.ndarray:
    criteria = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_COUNT, 200, 1e-15)
    rvec, tvec = cv2.solvePnPRefineLM(scene.X, scene.pixels, K, NO_DISTORTION, rvec.copy(), tvec.copy(), criteria)
    return from_opencv(rvec, tvec)


def angle(T_a: np.ndarray, T_b: np.ndarray) -> float:
    return float(np.linalg.norm(geometry.difference(T_a, T_b)[3:]))


def squares(scene: Scene, T: np.ndarray) -> float:
    p = geometry.transform(T, scene.X)
    return float((((p @ K.T)[:, :2] / p[:, 2:] - scene.pixels) ** 2).sum())


@pytest.mark.parametrize("method", ["SQPNP", "EPNP", "ITERATIVE"])
@pytest.mark.parametrize("distance", [4.0, 30.0])
def test_refine_reaches_opencvs_minimum(method: str, distance: float) -> None:
    rng = np.random.default_rng(1)
    compared = 0
    for _ in range(50):
        scene = make_scene(rng, 12, 0.5, (1.0, 1.0, 1.0), distance)
        found, rvec, tvec = cv2.solvePnP(
            scene.X, scene.pixels, K, NO_DISTORTION, flags=getattr(cv2, f"SOLVEPNP_{method}")
        )
        theirs = opencv_refined(scene, rvec, tvec)
        T, _, cost, _, _, ok = refine(scene, scene.T)
        assert ok
        if theirs[2, 3] <= 0.0:
            continue  # ITERATIVE from afar: the mirror image behind the camera
        # Never a worse minimum than theirs; where they found the same one the poses agree.
        assert cost * 0.25 <= squares(scene, theirs) * (1.0 + 1e-9)
        if found and abs(cost * 0.25 - squares(scene, theirs)) < 1e-6 * cost:
            compared += 1
            assert angle(T, theirs) < 1e-5
            assert np.linalg.norm(T[:3, 3] - theirs[:3, 3]) < 1e-5 * distance
    assert compared >= 45


def whitened_residuals(xi: np.ndarray, T: np.ndarray, scene: Scene, roots: np.ndarray) -> np.ndarray:
    p = geometry.transform(geometry.perturb(T, xi), scene.X)
    r = (p @ K.T)[:, :2] / p[:, 2:] - scene.pixels
    return np.einsum("nij,nj->ni", roots, r).ravel()


def test_refine_with_full_covariances_is_scipys_weighted_minimum() -> None:
    rng = np.random.default_rng(2)
    for _ in range(20):
        scene = make_scene(rng, 10, 1.0, (1.0, 1.0, 1.0), 8.0)
        A = rng.normal(size=(10, 2, 2))
        scene.covariances = A @ A.transpose(0, 2, 1) + 0.2 * np.eye(2)
        roots = np.linalg.inv(np.linalg.cholesky(scene.covariances))
        T, information, cost, inliers, _, ok = refine(scene, scene.T)
        assert ok
        assert inliers == 10
        oracle = least_squares(
            whitened_residuals,
            np.zeros(6),
            args=(scene.T, scene, roots),
            xtol=1e-15,
            ftol=1e-15,
            gtol=1e-15,
            x_scale="jac",
        )
        T_oracle = geometry.perturb(scene.T, oracle.x)
        assert cost == pytest.approx(2.0 * oracle.cost, rel=1e-10)
        assert angle(T, T_oracle) < 1e-6
        # Information: SciPy's Jacobian at the optimum, from its own differences.
        at_optimum = least_squares(whitened_residuals, np.zeros(6), args=(T, scene, roots), max_nfev=1, jac="3-point")
        assert np.allclose(
            information, at_optimum.jac.T @ at_optimum.jac, rtol=0.0, atol=1e-6 * np.abs(information).max()
        )


def test_refine_is_a_stationary_point_of_the_robust_cost() -> None:
    rng = np.random.default_rng(3)
    threshold = 9.21
    for _ in range(20):
        scene = make_scene(rng, 20, 0.5, (1.0, 1.0, 1.0), 6.0)
        scene.pixels[:5] = rng.uniform(0.0, 1024.0, (5, 2))
        T, information, cost, _, _, ok = refine(scene, scene.T, loss_threshold=threshold)
        assert ok

        def robust(xi: np.ndarray, T: np.ndarray = T, scene: Scene = scene) -> float:
            s = (whitened_residuals(xi, T, scene, np.tile(2.0 * np.eye(2), (20, 1, 1))).reshape(-1, 2) ** 2).sum(axis=1)
            return float(np.where(s <= threshold, s, threshold * (2.0 - threshold / np.maximum(s, threshold))).sum())

        assert cost == pytest.approx(robust(np.zeros(6)), rel=1e-9)
        steps = 1e-3 * np.linalg.inv(np.linalg.cholesky(information)).T  # columns: 1e-3 standard deviations
        slopes = [robust(step) - robust(-step) for step in steps.T]
        assert np.abs(slopes).max() < 1e-6


def test_p3p_has_poselibs_solutions() -> None:
    rng = np.random.default_rng(4)
    missed = extra = total = 0
    for _ in range(2000):
        scene = make_scene(rng, 3, 0.0, (1.0, 1.0, 1.0), rng.uniform(3.0, 50.0))
        rays = _core.unproject(CORE_CAMERA, scene.pixels)
        ours = _core.p3p(rays, scene.X)
        theirs = [np.vstack([pose.Rt, [0, 0, 0, 1]]) for pose in poselib.p3p(list(rays), list(scene.X))]
        assert min((angle(T, scene.T) for T in ours), default=1.0) < 1e-3
        missed += sum(all(angle(T, other) > 1e-3 for other in ours) for T in theirs)
        extra += sum(all(angle(T, other) > 1e-3 for other in theirs) for T in ours)
        total += len(ours)
    # Seen: none of 4,025. Double roots, which rounding splits or loses on either side, may differ.
    assert missed <= 0.001 * total
    assert extra <= 0.001 * total


def opencv_planar_pair(scene: Scene) -> list[np.ndarray]:
    """Both planar solutions, each refined, the better one first."""
    _, rvecs, tvecs, _ = cv2.solvePnPGeneric(scene.X, scene.pixels, K, NO_DISTORTION, flags=cv2.SOLVEPNP_IPPE)
    refined = [opencv_refined(scene, rvec, tvec) for rvec, tvec in zip(rvecs, tvecs, strict=True)]
    return sorted(refined, key=lambda T: squares(scene, T))


def test_pose_pair_has_both_of_ippes_solutions() -> None:
    rng = np.random.default_rng(5)
    pairs = 0
    for _ in range(100):
        scene = make_scene(rng, 8, 0.2, (1.0, 1.0, 0.0), 20.0)
        tilt = np.arccos(abs(scene.T[:3, 2] @ scene.T[:3, 3]) / np.linalg.norm(scene.T[:3, 3]))
        if not 0.4 < tilt < 1.2:
            continue  # nearly square on the two merge, edge on nothing is left of the image
        theirs = opencv_planar_pair(scene)
        best, other, distinct = _core.pose_pair(
            CORE_CAMERA, scene.T, scene.X, scene.landmarks, scene.pixels, scene.covariances, np.inf
        )
        assert best[5]
        assert angle(best[0], theirs[0]) < 1e-4
        if distinct:
            pairs += 1
            assert angle(other[0], theirs[1]) < 1e-4
            assert best[2] <= other[2]
    assert pairs >= 40


@pytest.mark.parametrize(("n", "outliers"), [(10, 3), (30, 15)])
def test_ransac_is_as_accurate_as_poselib(n: int, outliers: int) -> None:
    rng = np.random.default_rng(6)
    ours, theirs = [], []
    for seed in range(60):
        scene = make_scene(rng, n, 0.5, (1.0, 1.0, 1.0), 6.0)
        scene.pixels[:outliers] = rng.uniform(0.0, 1024.0, (outliers, 2))
        pose, _, ok = _core.ransac(
            CORE_CAMERA, scene.X, scene.landmarks, scene.pixels, scene.covariances, max_iterations=1000, seed=seed
        )
        options = {"max_reproj_error": 0.5 * np.sqrt(9.21), "seed": seed}
        reference, _ = poselib.estimate_absolute_pose(list(scene.pixels), list(scene.X), POSELIB_CAMERA, options, {})
        ours.append(angle(pose[0], scene.T) if ok else np.pi)
        theirs.append(angle(np.vstack([reference.Rt, [0, 0, 0, 1]]), scene.T))
    # Same data, same model: medians of 60 differ by chance by about 20 %.
    assert np.median(ours) < 1.2 * np.median(theirs)
    assert np.mean(np.array(ours) > 0.05) <= np.mean(np.array(theirs) > 0.05)


@pytest.mark.parametrize("kind", ["identical", "collinear", "nan", "three", "behind"])
def test_degenerate_views_give_nan_and_not_ok(kind: str) -> None:
    rng = np.random.default_rng(7)
    scene = make_scene(rng, 6, 0.0, (1.0, 1.0, 1.0), 6.0)
    if kind == "identical":
        scene.X[:] = scene.X[0]
    elif kind == "collinear":
        scene.X = np.linspace(-1.0, 1.0, 6)[:, None] * np.array([1.0, 2.0, -0.5])
        p = geometry.transform(scene.T, scene.X)
        scene.pixels = (p @ K.T)[:, :2] / p[:, 2:]
    elif kind == "nan":
        scene.pixels[:4] = np.nan
    elif kind == "three":
        scene = Scene(scene.X[:3], scene.T, scene.pixels[:3], scene.covariances[:3])
    else:
        scene.pixels = rng.uniform(0.0, 1024.0, (6, 2))
        scene.T[:3, 3] *= -1.0
    pose, _, ok = _core.ransac(CORE_CAMERA, scene.X, scene.landmarks, scene.pixels, scene.covariances)
    assert ok == bool(np.isfinite(pose[0]).all())
    assert not ok or kind == "behind"
    if kind == "behind":
        T, _, _, _, _, refined = refine(scene, scene.T)
        assert not refined or T[2, 3] > 0.0
    for result in (pose, refine(scene, scene.T)):
        assert result[5] or np.isnan(result[0]).all()


def test_bad_arguments_are_refused() -> None:
    scene = make_scene(np.random.default_rng(8), 5, 0.0, (1.0, 1.0, 1.0), 6.0)
    with pytest.raises(ValueError, match=r"T_start: expected a rigid motion .* got \[2 0 0 0;"):
        refine(scene, np.diag([2.0, 2.0, 2.0, 1.0]))
    with pytest.raises(ValueError, match="loss threshold: expected a number > 0, got -1"):
        refine(scene, scene.T, loss_threshold=-1.0)
    with pytest.raises(ValueError, match="landmarks: expected indices from 0 to 5 - 1, got 7 at 2"):
        _core.ransac(CORE_CAMERA, scene.X, np.array([0, 1, 7, 3, 4], np.int32), scene.pixels, scene.covariances)
    with pytest.raises(ValueError, match="got 5 landmarks, 4 pixels"):
        _core.ransac(CORE_CAMERA, scene.X, scene.landmarks, scene.pixels[:4], scene.covariances)
    with pytest.raises(ValueError, match="confidence: expected a number between 0 and 1"):
        _core.ransac(CORE_CAMERA, scene.X, scene.landmarks, scene.pixels, scene.covariances, confidence=1.0)
    with pytest.raises(TypeError):
        _core.p3p(np.zeros((4, 3)), np.zeros((3, 3)))
