"""The node's output, read by another implementation of DDS than the node's own."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from builders import EPOCH, make_calibration
from robot import imu, thermistor

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.demo.processes import running
from hgma_compensation.stamps import NANOSECONDS
from hgma_msgs.msg import CompensationState

pytestmark = pytest.mark.ros
NODE = [sys.executable, "-m", "hgma_compensation.node.main"]
READER = Path(__file__).parent / "cyclone_reader.py"
COUNT = 100

LOCALHOST = """<CycloneDDS><Domain>
  <General>
    <Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces><AllowMulticast>false</AllowMulticast>
  </General>
  <Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer Address="127.0.0.1"/></Peers></Discovery>
</Domain></CycloneDDS>"""
"""Cyclone DDS as ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST sets up the node's DDS: this machine only, no multicast."""


def plain(value):
    """Return a message, or a part of one, as JSON has it."""
    if hasattr(value, "get_fields_and_field_types"):
        return {name: plain(getattr(value, name)) for name in value.get_fields_and_field_types()}
    return value if isinstance(value, str | bool | int | float) else [plain(element) for element in value]


def test_cyclone_dds_reads_every_sample_with_equal_values(environment, robot, tmp_path):
    write_calibration(make_calibration(), tmp_path / "cal.json")
    fields = json.dumps(CompensationState.get_fields_and_field_types())
    command = [sys.executable, str(READER), environment["ROS_DOMAIN_ID"], str(COUNT), fields]
    variables = {**environment, "CYCLONEDDS_URI": LOCALHOST}
    node = [*NODE, "--ros-args", "-p", f"calibration_file:={tmp_path / 'cal.json'}", "-p", "state_rate:=0.0"]
    with (
        running(node, environment, "using"),
        subprocess.Popen(command, env=variables, stdout=subprocess.PIPE, text=True) as reader,
    ):
        assert reader.stdout.readline() == "matched\n"
        robot.connect()
        robot.temperature.publish(thermistor(EPOCH, 21.0))
        robot.spin(0.2)
        for number in range(COUNT):
            message = imu(EPOCH + NANOSECONDS + number * 10_000_000, [0.1 * number, -number, 9.81, 0.0, 0.0, 0.0])
            message.linear_acceleration_covariance[4] = 0.25 * number
            robot.raw.publish(message)
        robot.wait(lambda: len(robot.compensated) == len(robot.states) == COUNT, "all samples")
        received = json.loads(reader.communicate(timeout=40.0)[0])
    assert received["compensated"] == [plain(message) for message in robot.compensated]
    assert received["state"] == [plain(message) for message in robot.states]
