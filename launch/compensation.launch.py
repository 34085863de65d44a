"""Starts compensation_node: any parameter, topic, name and namespace as an argument.

An argument that is not given leaves the value of the parameter file. Of two sensors, include this file twice, each
inside a GroupAction with a namespace: docs/STACK.md.
"""

from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import LifecycleNode
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

from hgma_compensation.node.parameters import PARAMETERS, ParameterRow
from hgma_compensation.topics import INPUTS, OUTPUTS
from launch import LaunchContext, LaunchDescription

PACKAGE = "hgma_compensation"
PREFIX = "accel/"
RESPAWN_DELAY = 2.0
"""s, so that a node that cannot start does not fill the log."""


def generate_launch_description() -> LaunchDescription:
    """Return the arguments, and the node that is made of them."""
    parameter_file = PathJoinSubstitution([FindPackageShare(PACKAGE), "params", "compensation.yaml"])
    process = [
        DeclareLaunchArgument("params_file", default_value=parameter_file, description="Parameters of the node, YAML"),
        DeclareLaunchArgument("namespace", default_value="", description="Namespace of the node and its topics"),
        DeclareLaunchArgument("name", default_value="compensation_node", description="Name of the node"),
        DeclareLaunchArgument("log_level", default_value="info", description="debug, info, warn, error or fatal"),
        DeclareLaunchArgument("respawn", default_value="true", description="Start the node anew when it has ended"),
    ]
    topics = [
        DeclareLaunchArgument(_argument(topic), default_value=topic, description=f"Topic in the place of {topic}")
        for topic in INPUTS + OUTPUTS
    ]
    parameters = [
        DeclareLaunchArgument(row.name, default_value="", description=f"{row.description}. Default: of params_file")
        for row in PARAMETERS
    ]
    return LaunchDescription([*process, *topics, *parameters, OpaqueFunction(function=_node)])


def _argument(topic: str) -> str:
    """Return the argument that remaps a topic: raw for accel/raw."""
    return topic.removeprefix(PREFIX)


def _node(context: LaunchContext) -> list[LifecycleNode]:
    """Return the node, with what the arguments say once they have their values."""

    def text(argument: str) -> str:
        return LaunchConfiguration(argument).perform(context)

    given = {row.name: _value(row, text(row.name)) for row in PARAMETERS if text(row.name)}
    return [
        LifecycleNode(
            package=PACKAGE,
            executable="compensation_node",
            name=text("name"),
            namespace=text("namespace"),
            output="screen",
            respawn=_flag("respawn", text("respawn")),
            respawn_delay=RESPAWN_DELAY,
            parameters=[text("params_file"), *([given] if given else [])],
            remappings=[(topic, text(_argument(topic))) for topic in INPUTS + OUTPUTS],
            ros_arguments=["--log-level", text("log_level")],
        )
    ]


def _value(row: ParameterRow, text: str) -> bool | float | ParameterValue:
    """Return what launch_ros is to pass on for a parameter."""
    if isinstance(row.default, bool):
        return _flag(row.name, text)
    if isinstance(row.default, float):
        try:
            return float(text)
        except ValueError:
            raise ValueError(f"argument {row.name} is {text!r}: write a number") from None
    # Plain texts are read as YAML: a sensor called 0012 would become a number.
    return ParameterValue(text, value_type=str)


def _flag(argument: str, text: str) -> bool:
    if text.lower() not in ("true", "false"):
        raise ValueError(f"argument {argument} is {text!r}: write true or false")
    return text.lower() == "true"
