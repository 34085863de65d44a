"""What a broken sensor or driver sends to the real node: nothing is lost unsaid, and nothing broken gets through."""

import sys

import numpy as np
import pytest
from builders import EPOCH, make_calibration
from robot import imu, stamped, thermistor

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.demo.processes import running
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.pipeline.reasons import REMEDIES
from hgma_compensation.pipeline.status import TemperatureStatus
from hgma_compensation.stamps import NANOSECONDS
from hgma_msgs.msg import AccelBlock

pytestmark = pytest.mark.ros
STILL = [9.81] * 6


@pytest.fixture
def node(environment, tmp_path):
    """Start the node with a calibration and parameters."""
    write_calibration(make_calibration(mode=FilterMode.SMOOTH), tmp_path / "cal.json")

    def start(*parameters):
        given = [f"calibration_file:={tmp_path / 'cal.json'}", *parameters]
        words = [word for parameter in given for word in ("-p", parameter)]
        command = [sys.executable, "-m", "hgma_compensation.node.main", "--ros-args", *words]
        return running(command, environment, "using calibration")

    return start


def at(second):
    return EPOCH + round(second * NANOSECONDS)


def warm(robot, until=30):
    """Send a thermistor's samples until the temperature is OK at the stamps after them."""
    for second in range(until):
        robot.temperature.publish(thermistor(at(second), 25.0 + 0.01 * (second % 3)))
    robot.spin(0.3)


def said(robot, *names):
    """Wait until all counters are in the diagnostics and return its message and values."""
    robot.wait(lambda: all(int(robot.diagnosis()[2].get(name, "0")) for name in names), f"{names} in the diagnostics")
    _, _, values = robot.diagnosis()
    assert int(values["samples_received"]) == int(values["samples_compensated"]) + int(values["samples_skipped"])
    return values


def test_what_is_no_sample_is_skipped_by_name_and_what_is_odd_is_counted(robot, node):
    absent, odd = imu(at(30.5), STILL), imu(at(30.6), STILL)
    absent.linear_acceleration_covariance[0] = -1.0
    odd.linear_acceleration_covariance[:] = np.nan
    skipped = {
        "acceleration_not_stamped": imu(0, STILL),
        "acceleration_not_finite": imu(at(30.1), [np.nan] * 6),
        "acceleration_implausible": imu(at(30.2), [1e300] * 6),
        "acceleration_absent": absent,
    }
    with node("state_rate:=0.0"):
        robot.connect()
        warm(robot)
        for message in skipped.values():
            robot.raw.publish(message)
        kept = [odd, imu(at(30.7), STILL), imu(at(30.7), STILL), imu(at(30.65), STILL), imu(at(30.8), STILL, "other")]
        for message in kept:
            robot.raw.publish(message)
        robot.wait(lambda: len(robot.states) == len(robot.compensated) == len(kept), "the others")
        notes = ("covariance_invalid", "stamp_repeated", "out_of_order", "frame_changed")
        values = said(robot, *skipped, *(f"acceleration_{note}" for note in notes))
        assert {values[name] for name in skipped} == {"1"}
    for message in robot.compensated:
        assert np.isfinite(message.linear_acceleration_covariance).all()
        assert np.isfinite(message.linear_acceleration.x)
    assert [message.header.frame_id for message in robot.compensated] == ["imu_link"] * 4 + ["other"]
    assert set(skipped) <= set(REMEDIES)


def test_bytes_that_hold_no_message_are_counted_and_nothing_dies(robot, node):
    rubbish = (
        b"\x00\x01\x00\x00",
        b"\x00\x01\x00\x00 this is no message of the kind",
        b"\x00\x01\x00\x00" + b"\xff" * 400,
    )
    with node():
        robot.connect()
        warm(robot)
        for raw in rubbish:
            for publisher in (robot.raw, robot.raw_block, robot.temperature, robot.temperature_2, robot.supply_voltage):
                publisher.publish(raw)
        robot.spin(0.3)
        robot.raw.publish(imu(at(30.1), STILL))
        robot.wait(lambda: robot.compensated, "the sample after it")
        slow = [f"{name}_unreadable" for name in ("temperature", "temperature_2", "supply_voltage")]
        values = said(robot, "acceleration_unreadable", *slow)
        assert values["acceleration_unreadable"] == str(2 * len(rubbish))
        assert {values[name] for name in slow} == {str(len(rubbish))}
        assert {*slow, "acceleration_unreadable"} <= set(REMEDIES)


def test_another_frame_is_skipped_where_one_is_wanted(robot, node):
    with node("frame_id:=imu_link"):
        robot.connect()
        warm(robot)
        for second, frame in ((30.1, "imu_link"), (30.2, "camera_link"), (30.3, "imu_link")):
            robot.raw.publish(imu(at(second), STILL, frame))
            block = AccelBlock(sample_interval=0.001, x=[1.0], y=[1.0], z=[1.0])
            robot.raw_block.publish(stamped(block, at(second + 0.05), frame))
        robot.wait(lambda: len(robot.compensated) == len(robot.blocks) == 2, "samples of the frame")
        assert said(robot, "acceleration_of_another_frame")["acceleration_of_another_frame"] == "2"
        assert {message.header.frame_id for message in robot.compensated + robot.blocks} == {"imu_link"}


STATUSES = [
    (TemperatureStatus.OK, 30.0, None),
    (TemperatureStatus.STALE, 45.0, None),
    (TemperatureStatus.OUT_OF_RANGE, 100.0, 80.0),
    (TemperatureStatus.INVALID, 200.0, np.nan),
]


def publish_statuses(robot):
    """Send one acceleration in each status of the temperature."""
    for _, second, celsius in STATUSES:
        if celsius is not None:
            for back in range(30, 0, -1):
                noisy = (80.0 if np.isnan(celsius) else celsius) + 0.01 * (back % 3)
                robot.temperature.publish(thermistor(at(second - back * 0.9), noisy))
            robot.temperature.publish(thermistor(at(second - 0.3), celsius))
            robot.spin(0.3)
        robot.raw.publish(imu(at(second), STILL))
        robot.spin(0.2)


def test_with_a_bad_temperature_the_output_goes_on_flagged_and_less_certain(robot, node):
    with node():
        robot.connect()
        warm(robot)
        publish_statuses(robot)
        robot.wait(lambda: len(robot.states) == len(robot.compensated) == len(STATUSES), "an output in each status")
        said(robot, *(f"temperature_status_{s.name.lower()}" for s, _, _ in STATUSES[1:]), "temperature_not_finite")
    assert [state.temperature_status for state in robot.states] == [status for status, _, _ in STATUSES]
    variances = [message.linear_acceleration_covariance[::4].tolist() for message in robot.compensated]
    assert variances[0] == [0.0] * 3
    for state, found in zip(robot.states[1:], variances[1:], strict=True):
        assert found == pytest.approx(np.square(state.uncertainty).tolist())
        assert min(state.uncertainty) > min(robot.states[0].uncertainty)


def test_with_a_bad_temperature_the_output_stops_where_that_is_wanted(robot, node):
    with node("on_bad_temperature:=stop"):
        robot.connect()
        warm(robot)
        publish_statuses(robot)
        values = said(robot, "output_stopped")
        assert values["output_stopped"] == str(len(STATUSES) - 1)
        robot.wait(lambda: robot.compensated, "the output of the good one")
    assert [state.temperature_status for state in robot.states] == [TemperatureStatus.OK]
