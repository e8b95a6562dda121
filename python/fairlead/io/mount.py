# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""mount.toml -> where the camera sits on the vehicle, docs/files.md, docs/mavlink.md eq. (1)-(2)."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fairlead.geometry import exp_so3, matrix_from_quat_xyzw
from fairlead.io.documents import read_toml
from fairlead.io.fields import Fields
from fairlead.types import Matrix3, Matrix4, Vector3

R_FORWARD_CAMERA: Matrix3 = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""Camera axes (right, down, forward) in the axes of what it looks forward from (forward, right, down)."""

_QUATERNION_TOLERANCE = 1e-3
_ANGLES = ("roll_deg", "pitch_deg", "yaw_deg")


@dataclass(frozen=True, kw_only=True, eq=False)
class Gimbal:
    """A gimbal that tells its attitude."""

    position: Vector3
    """Its pivot in the body [m]."""
    device_id: int
    """As it stands in GIMBAL_DEVICE_ATTITUDE_STATUS; 0 takes any."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Mount:
    """The camera on the vehicle: forward, right, down."""

    T_carrier_camera: Matrix4
    """The carrier is the body or, with a gimbal, what the gimbal holds (origin: its pivot)."""
    gimbal: Gimbal | None = None


def load_mount(path: Path | str) -> Mount:
    """Read mount.toml. Raises InputError: file, key, what came, what was expected."""
    path = Path(path)
    top = Fields(read_toml(path), ("camera", "gimbal"), path)
    camera = Fields(top.get("camera"), ("position_m", "quat_xyzw", *_ANGLES), path, "camera")
    T = np.eye(4)
    T[:3, :3] = _rotation(camera)
    T[:3, 3] = camera.numbers("position_m", 3) if "position_m" in camera else np.zeros(3)
    gimbal = None
    if "gimbal" in top:
        fields = Fields(top.get("gimbal"), ("position_m", "device_id"), path, "gimbal")
        device = fields.integer("device_id") if "device_id" in fields else 0
        if not 0 <= device <= 255:
            raise fields.error("device_id", f"expected 0 to 255, got {device}")
        position = np.array(fields.numbers("position_m", 3)) if "position_m" in fields else np.zeros(3)
        gimbal = Gimbal(position=position, device_id=device)
    return Mount(T_carrier_camera=T, gimbal=gimbal)


def _rotation(camera: Fields) -> Matrix3:
    """R_carrier_camera from a quaternion, or yaw, then pitch, then roll of a camera that looked forward, eq. (1)."""
    angles = [key for key in _ANGLES if key in camera]
    if "quat_xyzw" in camera:
        if angles:
            raise camera.error(angles[0], "expected either quat_xyzw or angles, got both")
        quat_xyzw = np.array(camera.numbers("quat_xyzw", 4))
        if abs(float(np.linalg.norm(quat_xyzw)) - 1.0) > _QUATERNION_TOLERANCE:
            raise camera.error("quat_xyzw", f"expected a unit quaternion, got {quat_xyzw.tolist()}")
        return matrix_from_quat_xyzw(quat_xyzw)
    if not angles:
        raise camera.error("pitch_deg", "missing: where the camera looks (-90: down), or quat_xyzw")
    roll, pitch, yaw = (np.radians(camera.number(key)) if key in camera else 0.0 for key in _ANGLES)
    return rotation_from_euler(float(roll), float(pitch), float(yaw)) @ R_FORWARD_CAMERA


def rotation_from_euler(roll: float, pitch: float, yaw: float) -> Matrix3:
    """R = R_z(yaw) R_y(pitch) R_x(roll) [rad], as aircraft say it."""
    x, y, z = np.eye(3)
    return exp_so3(yaw * z) @ exp_so3(pitch * y) @ exp_so3(roll * x)
