# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The node alone: ros2 launch fairlead_ros track.launch.py target:=/data/target.csv camera:=/front."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """`camera` is the namespace of observations and camera_info; other parameters: ros2 param list."""
    target, camera = LaunchConfiguration("target"), LaunchConfiguration("camera")
    node = Node(
        package="fairlead_ros",
        executable="fairlead_node",
        name="fairlead",
        namespace=camera,
        parameters=[{"target": target}],
        output="screen",
    )
    return LaunchDescription(
        [
            DeclareLaunchArgument("target", description="Table name,x_m,y_m,z_m,sigma_m of the landmarks"),
            DeclareLaunchArgument("camera", default_value="", description="Namespace of the camera"),
            node,
        ]
    )
