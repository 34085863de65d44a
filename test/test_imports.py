import json
import subprocess
import sys

import pytest

OFFLINE = {"rosbags", "pymoo", "matplotlib", "allantools", "sklearn", "click", "rich"}
ROS = {"rclpy", "sensor_msgs", "hgma_msgs"}


def modules_after(statement):
    code = f"import sys, json\n{statement}\nprint(json.dumps(sorted({{name.split('.')[0] for name in sys.modules}})))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(json.loads(done.stdout.splitlines()[-1]))


@pytest.mark.parametrize(
    "module",
    [
        "loading.child",
        "loading.process",
        "pipeline.live",
        "pipeline.state_fields",
        "calibration.document",
        "training.train",
        "evaluation.evaluate",
    ],
)
def test_arithmetic_knows_no_ros(module):
    assert not modules_after(f"import hgma_compensation.{module}") & ROS


NODE = "import hgma_compensation.node.running, hgma_compensation.node.compensation_node"


def test_the_node_needs_nothing_of_the_offline_tools():
    assert not modules_after(NODE) & OFFLINE


def test_the_first_sample_waits_for_nothing_that_it_does_not_need(calibration_file):
    read = (
        "from pathlib import Path; from hgma_compensation.loading.job import Request, answer; "
        "from hgma_compensation.pipeline.live import LiveCompensation; "
        f"answer(Request(Path({str(calibration_file)!r}), None, '', LiveCompensation().histories())).calibration"
    )
    loaded = modules_after(f"{NODE}; {read}")
    assert "numpy" in loaded
    assert not loaded & {"scipy", "jsonschema", "subprocess", "tempfile", "shutil", "difflib"}
    assert not loaded & {"diagnostic_msgs", "std_srvs"}  # of services and diagnostics, which come after it


def test_discovery_begins_before_numpy_is_loaded():
    assert "numpy" not in modules_after("import hgma_compensation.node.running")


def test_the_command_imports_only_what_is_called():
    assert not modules_after("import hgma_compensation.cli.main") & ((OFFLINE - {"click"}) | ROS)


def test_the_node_catches_signals_before_it_loads_ros():
    assert not modules_after("import hgma_compensation.node.main") & (OFFLINE | ROS | {"numpy"})
