"""Starts compensation_node with topics remapped to a robot's own."""

from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import LifecycleNode
from launch_ros.parameter_descriptions import ParameterValue

from launch import LaunchDescription

TEXTS = (
    "calibration_file",
    "calibration_directory",
    "expected_sensor_id",
    "frame_id",
    "on_bad_temperature",
    "state_file",
)
"""Parameters of the node that are texts."""


def generate_launch_description() -> LaunchDescription:
    """Return the node and its arguments."""
    arguments = {
        "calibration_file": ("", "Calibration written by hgma train"),
        "calibration_directory": ("", "Directory that calibrations must lie in; empty: anywhere"),
        "expected_sensor_id": ("", "The sensor_id that a calibration must carry; empty: any"),
        "frame_id": ("", "header.frame_id that the accelerometer's messages must have; empty: any"),
        "on_bad_temperature": ("continue", "While the temperature is not usable: continue or stop"),
        "state_file": ("", "File that keeps the memories over a restart; empty: none"),
        "namespace": ("", "Namespace of the node and its topics"),
        "raw": ("accel/raw", "Topic of the raw sensor_msgs/Imu"),
        "temperature": ("accel/temperature", "Topic of the thermistor's sensor_msgs/Temperature"),
        "compensated": ("accel/compensated", "Topic of the compensated sensor_msgs/Imu"),
        "use_sim_time": ("false", "Follow /clock"),
        "respawn": ("true", "Start the node anew after it has ended by an error of its own"),
    }
    node = LifecycleNode(
        package="hgma_compensation",
        executable="compensation_node",
        name="compensation_node",
        namespace=LaunchConfiguration("namespace"),
        output="screen",
        respawn=LaunchConfiguration("respawn"),
        respawn_delay=2.0,
        parameters=[
            {name: ParameterValue(LaunchConfiguration(name), value_type=str) for name in TEXTS},
            {
                "use_sim_time": ParameterValue(LaunchConfiguration("use_sim_time"), value_type=bool),
            },
        ],
        remappings=[(f"accel/{name}", LaunchConfiguration(name)) for name in ("raw", "temperature", "compensated")],
    )
    declared = [
        DeclareLaunchArgument(name, default_value=default, description=text)
        for name, (default, text) in arguments.items()
    ]
    return LaunchDescription([*declared, node])
