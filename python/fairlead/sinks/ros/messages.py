# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What of an estimate goes into which ROS 2 message, docs/ros.md."""

from collections.abc import Sequence

import numpy as np

from fairlead.geometry import quat_xyzw_from_matrix
from fairlead.sinks.ros.cdr import CdrWriter
from fairlead.types import Estimate, Matrix6, Status

POSE = "geometry_msgs/msg/PoseWithCovarianceStamped"
TRANSFORMS = "tf2_msgs/msg/TFMessage"
DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"

_SEPARATOR = "=" * 80 + "\nMSG: "
_HEADER = "builtin_interfaces/Time stamp\nstring frame_id\n"
_PARTS = {
    "std_msgs/Header": _HEADER,
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n",
    "geometry_msgs/PoseWithCovariance": "geometry_msgs/Pose pose\nfloat64[36] covariance\n",
    "geometry_msgs/Pose": "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
    "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z\n",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z\n",
    "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
    "geometry_msgs/Transform": "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n",
    "geometry_msgs/TransformStamped": (
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"
    ),
    "diagnostic_msgs/DiagnosticStatus": (
        "byte level\nstring name\nstring message\nstring hardware_id\ndiagnostic_msgs/KeyValue[] values\n"
    ),
    "diagnostic_msgs/KeyValue": "string key\nstring value\n",
}
_TOPS = {
    POSE: ("std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose\n", "std_msgs/Header builtin_interfaces/Time "
           "geometry_msgs/PoseWithCovariance geometry_msgs/Pose geometry_msgs/Point geometry_msgs/Quaternion"),
    TRANSFORMS: ("geometry_msgs/TransformStamped[] transforms\n", "geometry_msgs/TransformStamped std_msgs/Header "
                 "builtin_interfaces/Time geometry_msgs/Transform geometry_msgs/Vector3 geometry_msgs/Quaternion"),
    DIAGNOSTICS: ("std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status\n", "std_msgs/Header "
                  "builtin_interfaces/Time diagnostic_msgs/DiagnosticStatus diagnostic_msgs/KeyValue"),
}  # fmt: skip

_OK, _WARN, _ERROR = 0, 1, 2
_LEVEL: dict[Status, int] = {"tracking": _OK, "coasting": _WARN, "acquiring": _WARN, "lost": _ERROR}


def definition(kind: str) -> str:
    """The text of a message's definition with those of its parts, as MCAP wants it."""
    top, parts = _TOPS[kind]
    return top + "".join(_SEPARATOR + name + "\n" + _PARTS[name] for name in parts.split())


def ros_covariance(estimate: Estimate) -> Matrix6:
    """S_ros = B S B^T, B = blkdiag(R, R), R = R_camera_target: camera axes, CONVENTIONS.md eq. (9)."""
    B = np.kron(np.eye(2), estimate.T_camera_target[:3, :3])
    return B @ estimate.covariance @ B.T


def pose_message(estimate: Estimate, camera_frame: str) -> bytes:
    """PoseWithCovarianceStamped of the target in the camera's frame; the estimate must be ok."""
    writer = CdrWriter()
    writer.header(estimate.stamp_ns, camera_frame)
    T = estimate.T_camera_target
    writer.float64(T[:3, 3].tolist())
    writer.float64(quat_xyzw_from_matrix(T[:3, :3]).tolist())
    writer.float64(ros_covariance(estimate).ravel().tolist())
    return writer.finish()


def transform_message(estimate: Estimate, camera_frame: str, target_frame: str) -> bytes:
    """TFMessage: the target as a child of the camera's frame; the estimate must be ok."""
    writer = CdrWriter()
    writer.uint32(1)
    writer.header(estimate.stamp_ns, camera_frame)
    writer.string(target_frame)
    T = estimate.T_camera_target
    writer.float64(T[:3, 3].tolist())
    writer.float64(quat_xyzw_from_matrix(T[:3, :3]).tolist())
    return writer.finish()


def diagnostic_message(estimate: Estimate, target_name: str) -> bytes:
    """DiagnosticArray: OK while tracking, WARN while coasting or acquiring, ERROR when lost; numbers beside it."""
    writer = CdrWriter()
    writer.header(estimate.stamp_ns, "")
    writer.uint32(1)
    writer.uint8(_LEVEL[estimate.status])
    reason = f": {estimate.reason}" if estimate.reason else ""
    for text in (f"fairlead: {target_name}", f"{estimate.status}{reason}", target_name):
        writer.string(text)
    values = diagnostic_values(estimate)
    writer.uint32(len(values))
    for key, value in values:
        writer.string(key)
        writer.string(value)
    return writer.finish()


def diagnostic_values(estimate: Estimate) -> Sequence[tuple[str, str]]:
    """Key and value of everything about an estimate but its pose."""
    position, attitude = (np.diag(estimate.covariance)[part].sum() for part in (slice(0, 3), slice(3, 6)))
    return (
        ("frame", str(estimate.frame)),
        ("status", estimate.status),
        ("reason", estimate.reason),
        ("inliers", str(estimate.n_inliers)),
        ("reprojection_rms_px", f"{estimate.reprojection_rms_px:.4g}"),
        ("sigma_position_m", f"{np.sqrt(position):.4g}"),
        ("sigma_attitude_rad", f"{np.sqrt(attitude):.4g}"),
        ("resets", str(estimate.reset_counter)),
    )
