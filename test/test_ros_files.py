import sys
from pathlib import Path

import pytest
import yaml
from rcl_interfaces.srv import ListParameters
from robot import Robot

from hgma_compensation.demo.processes import private_ros_environment, running
from hgma_compensation.pipeline.state_fields import FILTER_CODES
from hgma_compensation.pipeline.status import TemperatureStatus
from hgma_msgs.msg import CompensationState

ROOT = Path(__file__).parents[1]
PARAMETERS = ROOT / "params" / "compensation.yaml"


@pytest.mark.ros
def test_the_parameter_file_holds_every_parameter_of_the_node_and_no_other():
    environment = private_ros_environment()
    command = [sys.executable, "-m", "hgma_compensation.node.main", "--ros-args", "--params-file", str(PARAMETERS)]
    robot = Robot(int(environment["ROS_DOMAIN_ID"]))
    try:
        with running(command, environment, "no calibration yet"):
            names = set(robot.call(ListParameters, "list_parameters").result.names)
    finally:
        robot.close()
    # QoS overrides and type description are rclpy's own, the same for every node.
    own = {name for name in names if not name.startswith(("qos_overrides.", "start_type_description_service"))}
    assert own == set(yaml.safe_load(PARAMETERS.read_text())["/**"]["ros__parameters"])


def test_the_codes_of_the_state_are_those_of_the_message():
    assert {mode.name: code for mode, code in FILTER_CODES.items()} == _constants("FILTER_")
    assert {status.name: int(status) for status in TemperatureStatus} == _constants("TEMPERATURE_")


def _constants(prefix):
    names = (name for name in dir(CompensationState) if name.startswith(prefix))
    return {name.removeprefix(prefix): getattr(CompensationState, name) for name in names}
