"""The node on a clock that the test publishes: forward, backward, stopped, absent."""

import sys

import pytest
from builders import EPOCH, make_calibration
from robot import imu
from rosgraph_msgs.msg import Clock

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.demo.processes import running
from hgma_compensation.stamps import NANOSECONDS

pytestmark = pytest.mark.ros
STEP = 0.05
"""s between two messages on /clock."""


class Simulator:
    """Publishes /clock through the robot."""

    def __init__(self, robot):
        self._robot = robot
        self._publisher = robot.node.create_publisher(Clock, "/clock", 10)

    def run(self, start, seconds, rate=1.0):
        """Let time run from ``start`` s after the epoch of all tests for so many s of its own."""
        for number in range(round(seconds / rate / STEP)):
            message = Clock()
            message.clock.sec, message.clock.nanosec = divmod(
                EPOCH + round((start + number * STEP * rate) * NANOSECONDS), NANOSECONDS
            )
            self._publisher.publish(message)
            self._robot.spin(STEP)


@pytest.fixture
def simulator(robot):
    return Simulator(robot)


@pytest.fixture
def node(environment, tmp_path):
    write_calibration(make_calibration(), tmp_path / "cal.json")
    given = ["-p", f"calibration_file:={tmp_path / 'cal.json'}", "-p", "use_sim_time:=true"]
    command = [sys.executable, "-m", "hgma_compensation.node.main", "--ros-args", *given]
    with running(command, environment, "using calibration") as process:
        yield process


def reports(robot):
    """Return time (s after the epoch) and values of each report that has come."""
    return [
        (
            array.header.stamp.sec + array.header.stamp.nanosec * 1e-9 - EPOCH / NANOSECONDS,
            {value.key: value.value for value in array.status[0].values},
        )
        for array in robot.diagnostics
    ]


def test_diagnostics_follow_the_clock_and_survive_its_jumps(robot, simulator, node):
    log = robot.log()
    robot.connect()
    simulator.run(100.0, 6.0, rate=3.0)
    times = [time for time, _ in reports(robot)]
    assert 4 <= len(times) <= 7
    assert all(100.0 <= time <= 106.0 for time in times[1:])
    del robot.diagnostics[:]
    simulator.run(10.0, 6.0, rate=3.0)
    times = [time for time, _ in reports(robot)]
    assert 4 <= len(times) <= 7
    assert all(10.0 <= time <= 16.0 for time in times)
    values = reports(robot)[-1][1]
    assert values["ros_time_jumped_back"] == "1"
    assert sum("ROS time jumped back by 9" in line for line in log) == 1
    del robot.diagnostics[:]
    simulator.run(5000.0, 4.0, rate=3.0)
    assert all(5000.0 <= time <= 5004.0 for time, _ in reports(robot))
    assert len(robot.diagnostics) <= 5  # not one for each of the seconds that were jumped over
    assert reports(robot)[-1][1]["ros_time_jumped_back"] == "1"


def test_samples_go_on_through_a_jump_of_ros_time_and_their_rate_stays_a_rate(robot, simulator, node):
    robot.connect()
    simulator.run(100.0, 2.0)
    number = 0
    for start in (110.0, 20.0):
        for part in range(6):
            for _ in range(10):
                robot.raw.publish(imu(EPOCH + number * 10_000_000, [1.0] * 6))
                number += 1
            simulator.run(start + 0.5 * part, 0.5)
    assert len(robot.compensated) == number
    rates = [float(values["samples_per_second"]) for _, values in reports(robot)]
    assert all(0.0 <= rate <= 100.0 for rate in rates)
    after = [float(values["samples_per_second"]) for _, values in reports(robot) if "ros_time_jumped_back" in values]
    assert after[0] > 1.0  # samples came in the second that the jump lies in


@pytest.mark.slow
def test_a_clock_that_is_absent_or_stops_is_said_and_so_is_its_return(robot, simulator, node):
    log = robot.log()

    def said(part):
        return sum(part in line for line in log)

    robot.wait(lambda: said("nothing has moved the time on /clock") == 1, "a word about the absent clock")
    assert not robot.diagnostics
    simulator.run(10.0, 2.5)
    assert said("/clock moves") == 1
    assert robot.diagnostics
    robot.wait(lambda: said("nothing has moved the time on /clock") == 2, "a word about the clock that stopped")
    assert robot.set_parameter("use_sim_time", False).successful
    assert robot.diagnosis()[2]["lifecycle_state"] == "active"
