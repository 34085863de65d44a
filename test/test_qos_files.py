"""The QoS files: of the node's topics for rosbag2, and of the node itself."""

import sys
from itertools import product
from pathlib import Path

import pytest
import yaml
from rcl_interfaces.srv import GetParameters
from rclpy.qos import (
    HistoryPolicy,
    QoSCompatibility,
    QoSProfile,
    ReliabilityPolicy,
    qos_check_compatible,
    qos_profile_sensor_data,
    qos_profile_system_default,
)

from hgma_compensation.demo.processes import running
from hgma_compensation.node.interfaces import input_qos, output_qos
from hgma_compensation.topics import INPUTS, OUTPUTS, in_bag

pytestmark = pytest.mark.ros
PARAMS = Path(__file__).parents[1] / "params"
KINDS = {**{topic: "subscription" for topic in INPUTS}, **{topic: "publisher" for topic in OUTPUTS}}
POLICIES = ("history", "depth", "reliability")


def own(topic):
    return (output_qos if topic in OUTPUTS else input_qos)(topic)


def bag_profiles():
    """Read the file as ros2 bag does: ros2bag/api/__init__.py, short keys of each policy into a QoSProfile."""
    short = {
        "history": HistoryPolicy.get_from_short_key,
        "depth": int,
        "reliability": ReliabilityPolicy.get_from_short_key,
    }
    for topic, policies in yaml.safe_load((PARAMS / "bag_qos.yaml").read_text()).items():
        assert policies.pop("durability") == "volatile"
        yield topic, QoSProfile(**{name: short[name](value) for name, value in policies.items()})


def test_the_file_for_bags_has_the_node_s_topics_and_depths():
    profiles = dict(bag_profiles())
    assert list(profiles) == [in_bag(topic) for topic in INPUTS + OUTPUTS]
    assert {name: profile.depth for name, profile in profiles.items()} == {
        in_bag(topic): own(topic).depth for topic in INPUTS + OUTPUTS
    }


def test_a_recorder_hears_every_driver_and_the_node_and_the_node_hears_a_player():
    profiles = dict(bag_profiles())
    for topic in INPUTS:
        bag = profiles[in_bag(topic)]
        for driver in (qos_profile_sensor_data, qos_profile_system_default, QoSProfile(depth=1)):
            assert compatible(driver, bag)
        assert compatible(bag, own(topic))
    for topic in OUTPUTS:
        assert compatible(own(topic), profiles[in_bag(topic)])


def compatible(publisher, subscription):
    return qos_check_compatible(publisher, subscription)[0] is not QoSCompatibility.ERROR


def test_the_file_for_the_node_holds_its_defaults_for_each_topic():
    values = yaml.safe_load((PARAMS / "qos_overrides.yaml").read_text())["/**"]["ros__parameters"]["qos_overrides"]
    assert values == {
        in_bag(topic): {
            kind: {
                "history": own(topic).history.short_key,
                "depth": own(topic).depth,
                "reliability": own(topic).reliability.short_key,
            }
        }
        for topic, kind in KINDS.items()
    }


def test_the_node_takes_the_file_with_what_was_changed_in_it(robot, environment, calibration_file, tmp_path):
    text = (PARAMS / "qos_overrides.yaml").read_text()
    changed = text.replace("depth: 20000, reliability: best_effort", "depth: 7, reliability: reliable")
    assert changed != text
    (tmp_path / "qos.yaml").write_text(changed)
    files = (PARAMS / "compensation.yaml", tmp_path / "qos.yaml")
    command = [sys.executable, "-m", "hgma_compensation.node.main", "--ros-args"]
    for path in files:
        command += ["--params-file", str(path)]
    command += ["-p", f"calibration_file:={calibration_file}"]
    names = [f"qos_overrides.{in_bag(t)}.{kind}.{policy}" for (t, kind), policy in product(KINDS.items(), POLICIES)]
    log = robot.log()
    with running(command, environment, "using calibration"):
        robot.wait(lambda: infos(robot, "/accel/raw"), "the node's input")
        (raw,) = infos(robot, "/accel/raw")
        assert raw.qos_profile.reliability is ReliabilityPolicy.RELIABLE
        (temperature,) = infos(robot, "/accel/temperature")
        assert temperature.qos_profile.reliability is ReliabilityPolicy.BEST_EFFORT
        given = robot.call(GetParameters, "get_parameters", names=names).values
    values = {name: value.integer_value or value.string_value for name, value in zip(names, given, strict=True)}
    assert values["qos_overrides./accel/raw.subscription.depth"] == 7
    assert values["qos_overrides./accel/raw.subscription.reliability"] == "reliable"
    assert values["qos_overrides./accel/compensated.publisher.depth"] == 20_000
    assert all(values.values()), "a parameter of the file that the node does not have"
    assert not any("there is no parameter" in line for line in log)


def infos(robot, topic):
    found = robot.node.get_subscriptions_info_by_topic(topic)
    return [info for info in found if info.node_name == "compensation_node"]
