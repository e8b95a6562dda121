"""
The C++ core of fairlead. Private: use the typed wrappers of the package.
"""

from typing import Annotated

import numpy
from numpy.typing import NDArray

class Camera:
    def __init__(
        self,
        model: str,
        width: int,
        height: int,
        K: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order="C", device="cpu", writable=False)],
        distortion: Annotated[NDArray[numpy.float64], dict(shape=(None,), order="C", device="cpu", writable=False)],
    ) -> None: ...

def project(
    camera: Camera,
    points_camera: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
) -> NDArray[numpy.float64]:
    """Pixels (n, 2); NaN rows where a point has none."""

def unproject(
    camera: Camera,
    pixels: Annotated[NDArray[numpy.float64], dict(shape=(None, 2), order="C", device="cpu", writable=False)],
) -> NDArray[numpy.float64]:
    """Unit rays (n, 3); NaN rows where a pixel has none."""

def p3p(
    rays_camera: Annotated[NDArray[numpy.float64], dict(shape=(3, 3), order="C", device="cpu", writable=False)],
    X_target: Annotated[NDArray[numpy.float64], dict(shape=(3, 3), order="C", device="cpu", writable=False)],
) -> NDArray[numpy.float64]:
    """Poses (k, 4, 4), k <= 4."""

def pnp_refine(
    camera: Camera,
    T_start: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order="C", device="cpu", writable=False)],
    X_target: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    landmarks: Annotated[NDArray[numpy.int32], dict(shape=(None,), order="C", device="cpu", writable=False)],
    pixels: Annotated[NDArray[numpy.float64], dict(shape=(None, 2), order="C", device="cpu", writable=False)],
    covariances: Annotated[NDArray[numpy.float64], dict(shape=(None, 2, 2), order="C", device="cpu", writable=False)],
    loss_threshold: float = 9.21034037197618,
    max_iterations: int = 20,
) -> tuple:
    """(T_camera_target, information, cost, inliers, iterations, ok)."""

def ransac(
    camera: Camera,
    X_target: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    landmarks: Annotated[NDArray[numpy.int32], dict(shape=(None,), order="C", device="cpu", writable=False)],
    pixels: Annotated[NDArray[numpy.float64], dict(shape=(None, 2), order="C", device="cpu", writable=False)],
    covariances: Annotated[NDArray[numpy.float64], dict(shape=(None, 2, 2), order="C", device="cpu", writable=False)],
    loss_threshold: float = 9.21034037197618,
    max_iterations: int = 200,
    confidence: float = 0.9999,
    seed: int = 0,
) -> tuple:
    """(pose as of pnp_refine, iterations, ok)."""

def pose_pair(
    camera: Camera,
    T_start: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order="C", device="cpu", writable=False)],
    X_target: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    landmarks: Annotated[NDArray[numpy.int32], dict(shape=(None,), order="C", device="cpu", writable=False)],
    pixels: Annotated[NDArray[numpy.float64], dict(shape=(None, 2), order="C", device="cpu", writable=False)],
    covariances: Annotated[NDArray[numpy.float64], dict(shape=(None, 2, 2), order="C", device="cpu", writable=False)],
    loss_threshold: float = 9.21034037197618,
) -> tuple:
    """(best, other, distinct), poses as of pnp_refine."""

class TrackerOptions:
    def __init__(self) -> None: ...
    @property
    def max_views(self) -> int: ...
    @max_views.setter
    def max_views(self, arg: int, /) -> None: ...
    @property
    def loss_threshold(self) -> float: ...
    @loss_threshold.setter
    def loss_threshold(self, arg: float, /) -> None: ...
    @property
    def gate(self) -> float: ...
    @gate.setter
    def gate(self, arg: float, /) -> None: ...
    @property
    def min_inlier_ratio(self) -> float: ...
    @min_inlier_ratio.setter
    def min_inlier_ratio(self, arg: float, /) -> None: ...
    @property
    def coast_limit_s(self) -> float: ...
    @coast_limit_s.setter
    def coast_limit_s(self, arg: float, /) -> None: ...
    @property
    def max_step_rad(self) -> float: ...
    @max_step_rad.setter
    def max_step_rad(self, arg: float, /) -> None: ...
    @property
    def confirmations(self) -> int: ...
    @confirmations.setter
    def confirmations(self, arg: int, /) -> None: ...
    @property
    def ambiguity_log_odds(self) -> float: ...
    @ambiguity_log_odds.setter
    def ambiguity_log_odds(self, arg: float, /) -> None: ...
    @property
    def motion(self) -> str: ...
    @motion.setter
    def motion(self, arg: str, /) -> None: ...
    @property
    def jerk_density_m_s25(self) -> float: ...
    @jerk_density_m_s25.setter
    def jerk_density_m_s25(self, arg: float, /) -> None: ...
    @property
    def correlation_time_s(self) -> float: ...
    @correlation_time_s.setter
    def correlation_time_s(self, arg: float, /) -> None: ...
    @property
    def correlation_angle_rad(self) -> float: ...
    @correlation_angle_rad.setter
    def correlation_angle_rad(self, arg: float, /) -> None: ...
    @property
    def correlation_log_range(self) -> float: ...
    @correlation_log_range.setter
    def correlation_log_range(self, arg: float, /) -> None: ...
    @property
    def design_effect(self) -> float: ...
    @design_effect.setter
    def design_effect(self, arg: float, /) -> None: ...
    @property
    def range_to_origin(self) -> bool: ...
    @range_to_origin.setter
    def range_to_origin(self, arg: bool, /) -> None: ...
    @property
    def range_bias_sigma_m(self) -> float: ...
    @range_bias_sigma_m.setter
    def range_bias_sigma_m(self, arg: float, /) -> None: ...
    @property
    def seed(self) -> int: ...
    @seed.setter
    def seed(self, arg: int, /) -> None: ...

class BatchReadings:
    def __init__(self) -> None: ...
    def add_length(self, arg0: int, arg1: int, arg2: float, arg3: float, /) -> None: ...
    def add_range(self, arg0: int, arg1: float, arg2: float, arg3: int, /) -> None: ...
    def add_attitude(
        self,
        arg0: int,
        arg1: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order="C", device="cpu", writable=False)],
        arg2: float,
        /,
    ) -> None: ...

class Tracker:
    def __init__(
        self,
        arg0: Camera,
        arg1: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
        arg2: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order="C", device="cpu", writable=False)],
        arg3: TrackerOptions,
        /,
    ) -> None: ...
    def add_length(self, arg0: int, arg1: int, arg2: float, arg3: float, /) -> None: ...
    def add_range(self, arg0: int, arg1: float, arg2: float, arg3: int, /) -> None: ...
    def add_attitude(
        self,
        arg0: int,
        arg1: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order="C", device="cpu", writable=False)],
        arg2: float,
        /,
    ) -> None: ...
    def add_pose(
        self,
        arg0: int,
        arg1: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order="C", device="cpu", writable=False)],
        arg2: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order="C", device="cpu", writable=False)],
        /,
    ) -> None: ...
    def update(
        self,
        arg0: int,
        arg1: Annotated[NDArray[numpy.int32], dict(shape=(None,), order="C", device="cpu", writable=False)],
        arg2: Annotated[NDArray[numpy.float64], dict(shape=(None, 2), order="C", device="cpu", writable=False)],
        arg3: Annotated[NDArray[numpy.float64], dict(shape=(None, 2, 2), order="C", device="cpu", writable=False)],
        /,
    ) -> tuple: ...
    def predict(self, arg: int, /) -> tuple: ...
    def landmarks(self) -> NDArray[numpy.float64]: ...
    def landmark_covariance(self) -> NDArray[numpy.float64]: ...
    @property
    def noise_factor(self) -> float: ...
    @property
    def prior_factor(self) -> float: ...
    def gauge_sigma(self, arg: bool, /) -> NDArray[numpy.float64]: ...
    def predicted_gain(
        self,
        arg0: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order="C", device="cpu", writable=False)],
        arg1: float,
        /,
    ) -> float: ...
    @property
    def determined_directions(self) -> float: ...
    @property
    def ranges_believed(self) -> int: ...
    @property
    def ranges_refused(self) -> int: ...
    @property
    def range_bias(self) -> tuple: ...
    @property
    def views_in_window(self) -> int: ...

ORIGIN: int = -1

def refine(
    arg0: Camera,
    arg1: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    arg2: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order="C", device="cpu", writable=False)],
    arg3: Annotated[NDArray[numpy.int64], dict(shape=(None,), order="C", device="cpu", writable=False)],
    arg4: Annotated[NDArray[numpy.int32], dict(shape=(None,), order="C", device="cpu", writable=False)],
    arg5: Annotated[NDArray[numpy.int32], dict(shape=(None,), order="C", device="cpu", writable=False)],
    arg6: Annotated[NDArray[numpy.float64], dict(shape=(None, 2), order="C", device="cpu", writable=False)],
    arg7: Annotated[NDArray[numpy.float64], dict(shape=(None, 2, 2), order="C", device="cpu", writable=False)],
    arg8: TrackerOptions,
    arg9: BatchReadings,
    /,
) -> tuple: ...
def solve_window(
    camera: Camera,
    X: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    T: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order="C", device="cpu", writable=False)],
    view_index: Annotated[NDArray[numpy.int32], dict(shape=(None,), order="C", device="cpu", writable=False)],
    landmarks: Annotated[NDArray[numpy.int32], dict(shape=(None,), order="C", device="cpu", writable=False)],
    pixels: Annotated[NDArray[numpy.float64], dict(shape=(None, 2), order="C", device="cpu", writable=False)],
    covariances: Annotated[NDArray[numpy.float64], dict(shape=(None, 2, 2), order="C", device="cpu", writable=False)],
    prior_mean: object | None = None,
    prior_information: object | None = None,
    loss_threshold: float = float("inf"),
    max_iterations: int = 50,
    initial_damping: float = 0.0001,
    tolerance: float = 1e-09,
) -> tuple: ...

class FreeWindowOptions:
    def __init__(self) -> None: ...
    @property
    def max_iterations(self) -> int: ...
    @max_iterations.setter
    def max_iterations(self, arg: int, /) -> None: ...
    @property
    def initial_damping(self) -> float: ...
    @initial_damping.setter
    def initial_damping(self, arg: float, /) -> None: ...
    @property
    def tolerance(self) -> float: ...
    @tolerance.setter
    def tolerance(self, arg: float, /) -> None: ...
    @property
    def refine_start(self) -> bool: ...
    @refine_start.setter
    def refine_start(self, arg: bool, /) -> None: ...
    @property
    def pnp_after(self) -> bool: ...
    @pnp_after.setter
    def pnp_after(self, arg: bool, /) -> None: ...

class Flights:
    def __init__(
        self,
        camera: Camera,
        X_true: Annotated[NDArray[numpy.float64], dict(shape=(None, None, 3), order="C", device="cpu", writable=False)],
        X0: Annotated[NDArray[numpy.float64], dict(shape=(None, None, 3), order="C", device="cpu", writable=False)],
        P0: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order="C", device="cpu", writable=False)],
        stamps_ns: Annotated[NDArray[numpy.int64], dict(shape=(None,), order="C", device="cpu", writable=False)],
        T_true: Annotated[
            NDArray[numpy.float64], dict(shape=(None, None, 4, 4), order="C", device="cpu", writable=False)
        ],
        T_start: Annotated[
            NDArray[numpy.float64], dict(shape=(None, None, 4, 4), order="C", device="cpu", writable=False)
        ],
        pixels: Annotated[
            NDArray[numpy.float64], dict(shape=(None, None, None, 2), order="C", device="cpu", writable=False)
        ],
        covariances: Annotated[
            NDArray[numpy.float64], dict(shape=(None, None, None, 2, 2), order="C", device="cpu", writable=False)
        ],
    ) -> None: ...
    def solve(self, method: str, free_window: FreeWindowOptions, tracker: TrackerOptions, threads: int) -> tuple: ...
