"""The launch file, run against stand-ins of launch: the real launch is not on PyPI and cannot run on this machine.

What the stand-ins record is then given to the real node, with the words that launch_ros makes of it.
"""

import sys
from pathlib import Path

import pytest
import yaml
from builders import EPOCH
from launch_stand_ins import DeclareLaunchArgument, ParameterValue, description, launched
from rcl_interfaces.srv import GetParameters
from robot import imu
from sensor_msgs.msg import Imu

from hgma_compensation.demo.processes import running
from hgma_compensation.node.parameters import PARAMETERS
from hgma_compensation.topics import INPUTS, OUTPUTS

TOPICS = {topic.removeprefix("accel/"): topic for topic in INPUTS + OUTPUTS}
PROCESS = {"params_file", "namespace", "name", "log_level", "respawn"}


def test_every_parameter_and_topic_is_an_argument_and_nothing_else(monkeypatch):
    declared = [entity for entity in description(monkeypatch).entities if isinstance(entity, DeclareLaunchArgument)]
    assert sorted(argument.name for argument in declared) == sorted(
        [*PROCESS, *TOPICS, *(row.name for row in PARAMETERS)]
    )
    assert all(argument.description for argument in declared)


def test_without_arguments_the_parameter_file_of_the_package_decides(monkeypatch):
    node = launched(monkeypatch)
    (path,) = node.parameters
    assert set(yaml.safe_load(Path(path).read_text())["/**"]["ros__parameters"]) == {row.name for row in PARAMETERS}
    assert dict(node.remappings) == {topic: topic for topic in TOPICS.values()}
    assert (node.package, node.executable) == ("hgma_compensation", "compensation_node")
    assert (node.name, node.namespace, node.respawn) == ("compensation_node", "", True)


def test_what_is_given_comes_after_the_parameter_file_with_its_type(monkeypatch):
    node = launched(
        monkeypatch,
        params_file="mine.yaml",
        calibration_file="/calibrations/a.json",
        expected_sensor_id="0012",
        state_rate="50",
        use_sim_time="True",
        autostart="false",
        respawn="false",
    )
    path, given = node.parameters
    assert path == "mine.yaml"
    texts = {name: value.value for name, value in given.items() if isinstance(value, ParameterValue)}
    assert texts == {"calibration_file": "/calibrations/a.json", "expected_sensor_id": "0012"}
    others = {name: value for name, value in given.items() if name not in texts}
    assert others == {"state_rate": 50.0, "use_sim_time": True, "autostart": False}
    assert isinstance(others["state_rate"], float)
    assert node.respawn is False


@pytest.mark.parametrize(("argument", "value"), [("respawn", "yes"), ("autostart", "1"), ("state_rate", "fast")])
def test_a_value_that_is_none_is_refused_with_its_argument(monkeypatch, argument, value):
    with pytest.raises(ValueError, match=rf"^argument {argument} is '{value}': write "):
        launched(monkeypatch, **{argument: value})


@pytest.mark.ros
def test_the_node_takes_what_launch_hands_it(monkeypatch, robot, environment, calibration_file, tmp_path):
    node = launched(
        monkeypatch,
        namespace="front",
        name="drift",
        calibration_file=str(calibration_file),
        expected_sensor_id="imu_link",
        state_rate="50",
        raw="imu_raw/data_raw",
        compensated="imu/data_raw",
    )
    command = [sys.executable, "-m", "hgma_compensation.node.main", *node.words(tmp_path)]
    with running(command, environment, "using calibration"):
        raw = robot.node.create_publisher(Imu, "/front/imu_raw/data_raw", 10)
        out = robot.collect(Imu, "/front/imu/data_raw")
        robot.wait(lambda: raw.get_subscription_count() == 1, "the node's input in its namespace")
        robot.wait(lambda: robot.node.count_publishers("/front/imu/data_raw") == 1, "its output")
        assert robot.node.count_subscribers("/front/accel/temperature") == 1
        client = robot.client(GetParameters, "/front/drift/get_parameters")
        future = client.call_async(GetParameters.Request(names=["state_rate", "calibration_file", "state_period"]))
        robot.wait(future.done, "its parameters")
        values = future.result().values
        assert (values[0].double_value, values[1].string_value, values[2].double_value) == (
            50.0,
            str(calibration_file),
            10.0,
        )
        robot.spin(0.5)  # the node's side of the discovery
        raw.publish(imu(EPOCH, [0.0] * 6))
        robot.wait(lambda: out, "the compensated sample")
