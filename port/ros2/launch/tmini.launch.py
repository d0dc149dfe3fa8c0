# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""The node, and where the lidar is on the robot. tmini.launch.xml does the same."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

CONFIG = PathJoinSubstitution([FindPackageShare("tmini_ros"), "config"])
ARGUMENTS = [
    ("port", "/dev/ttyUSB0", "serial device, or tcp:HOST:PORT, unless the file names one"),
    ("params_file", PathJoinSubstitution([CONFIG, "tmini.yaml"]), "parameters"),
    ("name", "tmini", "name of the node, as in the file"),
    ("frame_id", "laser_frame", "the lidar's frame"),
    ("base_frame", "base_link", "the robot's frame"),
    ("publish_tf", "true", "false if the robot's model has the lidar's place"),
    ("x", "0", "metres ahead"),
    ("y", "0", "metres to the left"),
    ("z", "0", "metres up"),
    ("roll", "0", "radians"),
    ("pitch", "0", "radians"),
    ("yaw", "0", "radians, counter-clockwise"),
    ("rviz", "false", "true shows the scans"),
]


def generate_launch_description():
    given = {name: LaunchConfiguration(name) for name, _, _ in ARGUMENTS}
    place = [part for name in ("x", "y", "z", "roll", "pitch", "yaw") for part in ("--" + name, given[name])]
    return LaunchDescription([
        *(DeclareLaunchArgument(name, default_value=value, description=text) for name, value, text in ARGUMENTS),
        Node(package="tmini_ros", executable="tmini_node", name=given["name"], output="screen",
             parameters=[{"port": given["port"]}, given["params_file"], {"frame_id": given["frame_id"]}]),
        Node(package="tf2_ros", executable="static_transform_publisher", name=[given["name"], "_place"],
             condition=IfCondition(given["publish_tf"]),
             arguments=[*place, "--frame-id", given["base_frame"], "--child-frame-id", given["frame_id"]]),
        Node(package="rviz2", executable="rviz2", condition=IfCondition(given["rviz"]),
             arguments=["-d", PathJoinSubstitution([CONFIG, "tmini.rviz"]), "-f", given["frame_id"]]),
    ])
