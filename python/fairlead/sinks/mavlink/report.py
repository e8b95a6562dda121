# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""An estimate in the frames that autopilots accept, docs/mavlink.md eq. (2)-(6)."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from fairlead.geometry import point_covariance, quat_xyzw_from_matrix
from fairlead.io.mount import Mount
from fairlead.sinks.autopilots import Autopilot
from fairlead.sinks.mavlink.dialect import (
    FRAME_BODY_FRD,
    FRAME_LOCAL_NED,
    OBSERVED_BODY_FRD,
    OBSERVED_OFFSET_NED,
    VISION_FIDUCIAL,
    mavlink,
    target_relative,
)
from fairlead.sinks.mavlink.vehicle import VehicleState, camera_in_body
from fairlead.types import Estimate, Matrix3, Matrix4, Vector3


@dataclass(frozen=True, kw_only=True, eq=False)
class Sighting:
    """The touchdown point as the vehicle sees it."""

    stamp_us: int
    """This machine's clock."""
    p_body: Vector3
    """Forward, right, down from the body's origin [m]."""
    C_body: Matrix3
    """Its covariance [m^2]."""
    R_body_target: Matrix3
    S_body: Matrix3
    """Covariance of the target's attitude about body axes [rad^2]."""
    state: VehicleState


def sight(estimate: Estimate, X_target: Vector3, mount: Mount, state: VehicleState, stamp_us: int) -> Sighting | None:
    """p_body = T_body_camera T_camera_target X and its covariance, eq. (2)-(3); None where a gimbal is not known."""
    T_body_camera = camera_in_body(mount, state)
    if T_body_camera is None:
        return None
    T: Matrix4 = T_body_camera @ estimate.T_camera_target
    R = T[:3, :3]
    return Sighting(
        stamp_us=stamp_us,
        p_body=R @ X_target + T[:3, 3],
        C_body=point_covariance(T, estimate.covariance, X_target),
        R_body_target=R,
        S_body=R @ estimate.covariance[3:, 3:] @ R.T,
        state=state,
    )


def quat_wxyz(R: Matrix3) -> list[float]:
    """In MAVLink's order."""
    x, y, z, w = quat_xyzw_from_matrix(R).tolist()
    return [w, x, y, z]


def landing_target(sighting: Sighting, autopilot: Autopilot) -> Any:
    """LANDING_TARGET in the one frame that this autopilot takes; None where its frame is not known yet, eq. (5)."""
    frame, p, R_frame_target = FRAME_BODY_FRD, sighting.p_body, sighting.R_body_target
    distance = float(np.linalg.norm(p))
    if autopilot == "px4":
        state = sighting.state
        if state.R_ned_body is None or state.p_ned is None:
            return None
        frame = FRAME_LOCAL_NED
        p, R_frame_target = state.p_ned + state.R_ned_body @ p, state.R_ned_body @ sighting.R_body_target
    return mavlink().MAVLink_landing_target_message(
        sighting.stamp_us,
        0,
        frame,
        0.0,
        0.0,
        distance,
        0.0,
        0.0,
        *p.tolist(),
        quat_wxyz(R_frame_target),
        VISION_FIDUCIAL,
        1,
    )


def relative_target(sighting: Sighting) -> Any:
    """TARGET_RELATIVE: in NED from the vehicle where its attitude is known, else in body axes, eq. (6)."""
    R_frame_body, frame, quat_sensor = np.eye(3), OBSERVED_BODY_FRD, [0.0] * 4
    if sighting.state.R_ned_body is not None:
        R_frame_body, frame, quat_sensor = sighting.state.R_ned_body, OBSERVED_OFFSET_NED, [1.0, 0.0, 0.0, 0.0]
    p = R_frame_body @ sighting.p_body
    sigmas = np.sqrt(np.diag(R_frame_body @ sighting.C_body @ R_frame_body.T).clip(0.0))
    yaw_sigma = float(np.sqrt(max((R_frame_body @ sighting.S_body @ R_frame_body.T)[2, 2], 0.0)))
    quat_target = quat_wxyz(R_frame_body @ sighting.R_body_target)
    return target_relative()(
        *(sighting.stamp_us, 0, frame, *p.tolist(), sigmas.tolist(), yaw_sigma, quat_target, quat_sensor),
        VISION_FIDUCIAL,
    )
