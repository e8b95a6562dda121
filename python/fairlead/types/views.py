# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""View in, estimate out."""

from dataclasses import dataclass
from typing import Protocol, get_args, runtime_checkable

import numpy as np

from fairlead.types.arrays import Matrix4, Matrix6, PixelCovariances, Pixels, Scores, Status
from fairlead.types.checks import assign, choice, frozen_array, integer, is_covariance, is_rigid, names
from fairlead.types.models import Target


@dataclass(frozen=True, kw_only=True, eq=False)
class View:
    """The observations of one image. Numbers that are not finite are allowed here: the estimator drops them."""

    frame: int
    """Number of the image."""
    stamp_ns: int
    """Time it was taken [ns]."""
    landmarks: tuple[str, ...]
    pixels: Pixels
    """(n, 2) [px]; (0, 0) is the centre of the top-left pixel."""
    covariances: PixelCovariances
    """(n, 2, 2) [px^2]"""
    scores: Scores | None = None
    """Confidence of the detector, as it came [-]."""

    def __post_init__(self) -> None:
        assign(self, frame=integer(self.frame, "view frame"), stamp_ns=integer(self.stamp_ns, "view stamp_ns"))
        landmarks = names(self.landmarks, "view landmarks")
        n = len(landmarks)
        pixels = frozen_array(self.pixels, (n, 2), "view pixels")
        covariances = frozen_array(self.covariances, (n, 2, 2), "view covariances")
        assign(self, landmarks=landmarks, pixels=pixels, covariances=covariances)
        if self.scores is not None:
            assign(self, scores=frozen_array(self.scores, (n,), "view scores"))


@dataclass(frozen=True, kw_only=True, eq=False)
class Estimate:
    """What one update returns. Unless `ok`, the pose and its covariance are NaN and `reason` says why."""

    frame: int
    stamp_ns: int
    status: Status
    reason: str
    """Empty if there is none."""
    T_camera_target: Matrix4
    """p_camera = T_camera_target p_target, frame of the prior model."""
    covariance: Matrix6
    """Of xi = (rho, phi) in T Exp(xi): target axes [m, rad], gauge uncertainty included."""
    n_inliers: int
    reprojection_rms_px: float
    information_gained: float
    """Decrease of the entropy of the landmark model by this view [nat]."""
    reset_counter: int
    """Increments when the pose jumps."""
    inliers: tuple[str, ...]
    n_dropped: int = 0
    """Observations that no estimator can use: not finite, no positive definite covariance, or the landmark twice."""

    def __post_init__(self) -> None:
        for name in ("frame", "stamp_ns", "n_inliers", "reset_counter", "n_dropped"):
            assign(self, **{name: integer(getattr(self, name), f"estimate {name}")})
        choice(self.status, get_args(Status), "estimate status")
        T = frozen_array(self.T_camera_target, (4, 4), "estimate T_camera_target")
        covariance = frozen_array(self.covariance, (6, 6), "estimate covariance")
        if self.ok and not is_rigid(T):
            raise ValueError(f"estimate T_camera_target: expected a rigid motion, got {T.tolist()}")
        if self.ok and not is_covariance(covariance):
            raise ValueError("estimate covariance: expected a finite, symmetric, positive semidefinite matrix")
        if not self.ok and not (np.isnan(T).all() and np.isnan(covariance).all()):
            raise ValueError(f"estimate: expected NaN pose and covariance where the status is {self.status}")
        assign(self, T_camera_target=T, covariance=covariance, inliers=names(self.inliers, "estimate inliers"))

    @property
    def ok(self) -> bool:
        """Whether there is a pose: status tracking or coasting."""
        return self.status in ("tracking", "coasting")

    @property
    def in_doubt(self) -> bool:
        """Whether there is a pose, but the data contradict what was told, docs/estimator.md section 8."""
        return self.ok and self.reason in ("alarm", "contradiction")


def no_pose(view: View, status: Status, reason: str) -> Estimate:
    """An estimate that says why there is none."""
    return Estimate(
        frame=view.frame,
        stamp_ns=view.stamp_ns,
        status=status,
        reason=reason,
        T_camera_target=np.full((4, 4), np.nan),
        covariance=np.full((6, 6), np.nan),
        n_inliers=0,
        reprojection_rms_px=float("nan"),
        information_gained=0.0,
        reset_counter=0,
        inliers=(),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class TruthPose:
    """A pose known from elsewhere."""

    frame: int
    stamp_ns: int
    T_camera_target: Matrix4

    def __post_init__(self) -> None:
        assign(self, frame=integer(self.frame, "truth frame"), stamp_ns=integer(self.stamp_ns, "truth stamp_ns"))
        T = frozen_array(self.T_camera_target, (4, 4), "truth T_camera_target")
        if not is_rigid(T):
            raise ValueError(f"truth T_camera_target: expected a rigid motion, got {T.tolist()}")
        assign(self, T_camera_target=T)


@runtime_checkable
class PoseEstimator(Protocol):
    """What `map`, `window` and `epnp` share: a view in, an estimate out; bad data never raise."""

    def update(self, view: View) -> Estimate:
        """Take in one view; the estimate says whether there is a pose."""
        ...

    @property
    def model(self) -> Target:
        """The landmark model as it is now."""
        ...
