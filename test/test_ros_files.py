import re
import sys
from pathlib import Path

import pytest
import yaml
from rcl_interfaces.srv import ListParameters
from robot import Robot

from hgma_compensation.demo.processes import private_ros_environment, running
from hgma_compensation.node.parameters import PARAMETERS as PARAMETER_ROWS
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


@pytest.mark.ros
def test_the_parameter_file_says_of_each_parameter_its_default_its_range_and_whether_it_is_read_only():
    text = PARAMETERS.read_text()
    values = yaml.safe_load(text)["/**"]["ros__parameters"]
    comments = {}
    for block in text.split("ros__parameters:\n")[1].split("\n\n"):
        *lines, last = block.strip().splitlines()
        comments[last.partition(":")[0].strip()] = " ".join(line.strip().removeprefix("#").strip() for line in lines)
    for row in PARAMETER_ROWS:
        assert values[row.name] == row.default
        comment = comments[row.name]
        assert ("read-only" in comment) == row.read_only, row.name
        if row.bounds is not None:
            low, high = (f"{bound:g}".replace("e+0", "e") for bound in row.bounds)
            unit = "Hz" if row.name == "state_rate" else "s"
            assert comment.startswith(f"{unit}, {low} to {high}"), row.name
        for choice in row.choices:
            assert choice in comment.partition(",")[0], row.name


@pytest.mark.parametrize("path", sorted((ROOT / "hgma_msgs").rglob("*.[ms][sr][gv]")), ids=lambda path: path.name)
def test_every_field_of_the_messages_is_described_and_every_number_has_its_unit(path):
    lines = [line for line in path.read_text().splitlines() if line and not line.startswith(("#", "---"))]
    for kind, _, comment in (re.fullmatch(r"(\S+) +(\S+) +# (.+)", line).groups() for line in lines):
        if kind.startswith("float"):
            assert re.match(r"(s|V|m/s\^2|degC|degC/s|degC\^2|unit of the channel)\b", comment), comment
