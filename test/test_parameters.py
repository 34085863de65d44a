import re
import sys
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from rcl_interfaces.srv import DescribeParameters

from hgma_compensation.demo.processes import running
from hgma_compensation.errors import RefusedError
from hgma_compensation.node.parameters import PARAMETERS, ParameterRow, check_qos_override, unknown_names

pytestmark = pytest.mark.ros
ROOT = Path(__file__).parents[1]


def test_the_parameter_file_lists_the_table_in_its_order_with_its_defaults():
    written = yaml.safe_load((ROOT / "params" / "compensation.yaml").read_text())["/**"]["ros__parameters"]
    assert list(written.items()) == [(row.name, row.default) for row in PARAMETERS]


def test_the_reference_documents_every_parameter():
    rows = re.findall(r"^\| `(\w+)` \|", (ROOT / "docs" / "REFERENCE.md").read_text(), re.MULTILINE)
    assert {row.name for row in PARAMETERS} <= set(rows)


def test_every_parameter_is_described_and_every_number_has_a_range():
    for row in PARAMETERS:
        assert row.description
        number = isinstance(row.default, int | float) and not isinstance(row.default, bool)
        assert (row.bounds is not None) is number
        if row.bounds is not None:
            assert row.bounds[0] <= row.default <= row.bounds[1]


def test_the_running_node_describes_each_of_its_parameters(environment, robot):
    command = [sys.executable, "-m", "hgma_compensation.node.main"]
    names = [row.name for row in PARAMETERS]
    with running(command, environment, "no calibration yet"):
        described = robot.call(DescribeParameters, "describe_parameters", names=names).descriptors
        assert [d.description for d in described] == [row.description for row in PARAMETERS]
        assert [d.read_only for d in described] == [row.read_only for row in PARAMETERS]
        assert not robot.set_parameter("autostart", False).successful
        assert not robot.set_parameter("use_sim_time", "maybe").successful
        assert not robot.set_parameter("calibration_file", 7).successful
        assert robot.diagnosis()[2]["lifecycle_state"] == "active"


def test_a_range_is_that_of_the_number_s_type():
    real = ParameterRow("period", 5.0, "s", bounds=(0.5, 60.0)).descriptor()
    assert (real.floating_point_range[0].from_value, real.floating_point_range[0].to_value) == (0.5, 60.0)
    assert not real.integer_range
    whole = ParameterRow("count", 5, "times", bounds=(1, 9)).descriptor()
    assert (whole.integer_range[0].from_value, whole.integer_range[0].to_value) == (1, 9)
    assert not whole.floating_point_range


def test_the_nearest_name_is_offered_and_none_where_all_are_far():
    known = ["calibration_file", "autostart"]
    assert unknown_names(["autostrat", "zzz", "autostart"], known) == {"autostrat": "autostart", "zzz": ""}


@given(st.one_of(st.integers(max_value=0), st.text(), st.floats(), st.booleans()))
def test_a_depth_that_is_no_count_is_refused(value):
    with pytest.raises(RefusedError, match="depth"):
        check_qos_override("qos_overrides./accel/raw.subscription.depth", value)


@given(st.one_of(st.text(max_size=8), st.integers(), st.booleans()))
def test_a_policy_takes_its_own_values_only(value):
    for good in ("reliable", "best_effort"):
        check_qos_override("qos_overrides./a.publisher.reliability", good)
    with pytest.raises(RefusedError, match="best_effort"):
        check_qos_override("qos_overrides./a.publisher.reliability", value)
