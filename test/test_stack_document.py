"""The snippets of docs/STACK.md: what they name exists, here and in the packages that they configure."""

import ast
import re
from pathlib import Path

import pytest
import yaml
from launch_stand_ins import DeclareLaunchArgument, description

from hgma_compensation.topics import INPUTS, OUTPUTS

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "docs" / "STACK.md").read_text(encoding="utf-8")
YAML = [yaml.safe_load(block) for block in re.findall(r"^```yaml\n(.*?)^```", TEXT, re.MULTILINE | re.DOTALL)]
PYTHON = re.findall(r"^```python\n(.*?)^```", TEXT, re.MULTILINE | re.DOTALL)
LAUNCHES = re.findall(
    r"^ros2 launch hgma_compensation compensation.launch.py((?:.|\\\n)*?)(?<!\\)$", TEXT, re.MULTILINE
)

PARAMETERS = {
    # imu_tools, imu_filter_madgwick/src/imu_filter_ros.cpp
    "imu_filter_madgwick": {
        *("stateless", "use_mag", "publish_tf", "reverse_tf", "fixed_frame", "constant_dt", "remove_gravity_vector"),
        *("publish_debug_topics", "yaw_offset", "declination", "world_frame", "gain", "zeta", "mag_bias_x"),
        *("mag_bias_y", "mag_bias_z", "orientation_stddev"),
    },
    # imu_tools, imu_complementary_filter/src/complementary_filter_ros.cpp
    "ComplementaryFilterROS": {
        *("fixed_frame", "use_mag", "publish_tf", "reverse_tf", "constant_dt", "publish_debug_topics", "gain_acc"),
        *("gain_mag", "do_bias_estimation", "bias_alpha", "do_adaptive_gain", "orientation_stddev"),
    },
    # nav2_lifecycle_manager/src/lifecycle_manager.cpp
    "lifecycle_manager": {
        *("node_names", "autostart", "bond_timeout", "attempt_respawn_reconnection", "bond_respawn_max_duration"),
    },
    # robot_localization, params/ekf.yaml and src/ros_filter.cpp; of each sensor: _config, _queue_size, …
    "ekf_filter_node": {
        *("frequency", "two_d_mode", "map_frame", "odom_frame", "base_link_frame", "world_frame"),
        *("odom", "odom_config"),
        *("imu", "imu_config", "imu_queue_size", "imu_relative", "imu_differential"),
        *("imu_remove_gravitational_acceleration", "imu_linear_acceleration_rejection_threshold"),
    },
}
"""Names that the packages' own sources declare."""


@pytest.mark.parametrize("document", YAML, ids=lambda document: next(iter(document)))
def test_parameters_of_other_packages_are_theirs(document):
    ((node, content),) = document.items()
    values = content["ros__parameters"]
    assert {re.sub(r"^(imu|odom)\d", r"\1", name) for name in values} <= PARAMETERS[node]
    for name, value in values.items():
        if name.endswith("_config"):
            assert len(value) == 15
            assert all(type(one) is bool for one in value)


def test_there_is_a_snippet_for_each_of_them():
    assert {next(iter(document)) for document in YAML} == set(PARAMETERS)


@pytest.fixture
def arguments(monkeypatch):
    return {one.name for one in description(monkeypatch).entities if isinstance(one, DeclareLaunchArgument)}


@pytest.mark.ros
def test_the_launch_example_gives_arguments_that_exist(arguments):
    (source,) = PYTHON
    tree = ast.parse(source)
    assert "generate_launch_description" in {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    given = [key.value for node in ast.walk(tree) if isinstance(node, ast.Dict) for key in node.keys]
    assert given
    assert set(given) <= arguments


@pytest.mark.ros
def test_launch_commands_give_arguments_that_exist(arguments):
    assert len(LAUNCHES) == 2
    assert "compensated:=imu/data_raw" in LAUNCHES[0]
    for line in LAUNCHES:
        assert set(re.findall(r"(\w+):=", line)) <= arguments


def test_every_topic_of_the_node_is_an_argument_of_the_table():
    row = next(line for line in TEXT.splitlines() if line.startswith("| `raw`, `temperature`"))
    assert set(re.findall(r"`(\w+)`", row.split("|")[1])) == {
        topic.removeprefix("accel/") for topic in INPUTS + OUTPUTS
    }
