"""QoS of the node's topics over DDS: defaults, overrides, what does not fit, what is lost."""

import sys
import time

import pytest
from builders import EPOCH, make_calibration
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from robot import imu
from sensor_msgs.msg import Imu

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.demo.processes import running
from hgma_compensation.messages import stamp_of

pytestmark = pytest.mark.ros
BEST_EFFORT, RELIABLE = ReliabilityPolicy.BEST_EFFORT, ReliabilityPolicy.RELIABLE
SAMPLES = [imu(EPOCH + number * 10_000_000, [float(number)] * 6) for number in range(400)]


@pytest.fixture
def node(environment, tmp_path):
    """Return a function that runs the node with a calibration and further parameters."""
    write_calibration(make_calibration(), tmp_path / "cal.json")

    def run(*parameters):
        given = (f"calibration_file:={tmp_path / 'cal.json'}", *parameters)
        words = [word for parameter in given for word in ("-p", parameter)]
        command = [sys.executable, "-m", "hgma_compensation.node.main", "--ros-args", *words]
        return running(command, environment, "using calibration")

    return run


def qos(reliability, depth=1000):
    return QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=depth, reliability=reliability)


def collect(robot, topic, reliability):
    messages = []
    robot.node.create_subscription(Imu, topic, messages.append, qos(reliability))
    return messages


def offered(robot, topic):
    """Return reliability and depth of the node's publisher or subscription of a topic."""
    infos = (
        robot.node.get_publishers_info_by_topic
        if topic in ("/accel/compensated", "/accel/compensated_block", "/accel/state")
        else robot.node.get_subscriptions_info_by_topic
    )
    robot.wait(lambda: any(info.node_name == "compensation_node" for info in infos(topic)), topic)
    (info,) = (info for info in infos(topic) if info.node_name == "compensation_node")
    return info.qos_profile.reliability


def test_best_effort_and_reliable_drivers_and_readers_are_all_served(robot, node):
    unsure = collect(robot, "accel/compensated", BEST_EFFORT)
    driver = robot.node.create_publisher(Imu, "accel/raw", qos(BEST_EFFORT))
    with node():
        robot.connect()
        robot.wait(lambda: driver.get_subscription_count() == 1, "the node to hear the best-effort driver")
        assert offered(robot, "/accel/compensated") is RELIABLE
        assert offered(robot, "/accel/raw") is BEST_EFFORT
        for first, second in zip(SAMPLES[0:20:2], SAMPLES[1:20:2], strict=True):
            driver.publish(first)
            robot.raw.publish(second)
            robot.spin(0.02)
        robot.wait(lambda: len(robot.compensated) == len(unsure) == 20, "the samples of both drivers at both readers")
        robot.node.destroy_publisher(driver)
        again = robot.node.create_publisher(Imu, "accel/raw", qos(BEST_EFFORT))
        robot.wait(lambda: again.get_subscription_count() == 1, "the node to hear the driver that was started anew")
        robot.spin(0.5)
        again.publish(SAMPLES[20])
        robot.wait(lambda: len(robot.compensated) == 21, "its sample")
        assert "raw_lost_in_transport" not in robot.diagnosis()[2]  # two numberings, and one that began anew


def test_a_reader_that_comes_late_gets_what_is_published_from_then_on(robot, node):
    with node():
        robot.connect()
        for sample in SAMPLES[:10]:
            robot.raw.publish(sample)
        robot.wait(lambda: len(robot.compensated) == 10, "the first samples")
        late = collect(robot, "accel/compensated", RELIABLE)
        robot.spin(1.0)
        assert not late
        for sample in SAMPLES[10:20]:
            robot.raw.publish(sample)
        robot.wait(lambda: len(late) == 10, "the samples after it came")
    assert [stamp_of(message) for message in late] == [stamp_of(sample) for sample in SAMPLES[10:20]]


def test_an_override_changes_its_own_topic_and_no_other(robot, node):
    with node(
        "qos_overrides./accel/temperature.subscription.reliability:=reliable",
        "qos_overrides./accel/compensated.publisher.reliability:=best_effort",
    ):
        assert offered(robot, "/accel/temperature") is RELIABLE
        assert {offered(robot, topic) for topic in ("/accel/raw", "/accel/temperature_2")} == {BEST_EFFORT}
        assert offered(robot, "/accel/compensated") is BEST_EFFORT
        assert {offered(robot, topic) for topic in ("/accel/compensated_block", "/accel/state")} == {RELIABLE}


def test_qos_that_does_not_fit_is_logged_with_its_policy_and_counted_by_topic(robot, node):
    log = robot.log()
    with node(
        "qos_overrides./accel/raw.subscription.reliability:=reliable",
        "qos_overrides./accel/compensated.publisher.reliability:=best_effort",
    ):
        unheard = [robot.node.create_publisher(Imu, "accel/raw", qos(BEST_EFFORT))]
        robot.wait(lambda: robot.diagnosis()[2].get("raw_qos_incompatible") == "1", "the driver that is not heard")
        values = robot.diagnosis()[2]
        assert values["compensated_qos_incompatible"] == "1"  # the robot's own reader, which asks for reliable
        assert "state_qos_incompatible" not in values
        # One more of the same kind is counted and not logged again.
        unheard.append(robot.node.create_publisher(Imu, "accel/raw", qos(BEST_EFFORT)))
        robot.wait(lambda: robot.diagnosis()[2]["raw_qos_incompatible"] == "2", "the second driver")
        assert len([line for line in log if "set qos_overrides./accel/raw.subscription.reliability" in line]) == 1
        assert any("set qos_overrides./accel/compensated.publisher.reliability" in line for line in log)
        robot.diagnosis()
        message = robot.diagnosis()[1]  # no event has come since the one before, and it still says so
        assert "raw_qos_incompatible: accel/raw" in message
        assert "compensated_qos_incompatible: accel/compensated" in message
        for publisher in unheard:
            robot.node.destroy_publisher(publisher)
        robot.wait(lambda: "raw_qos_incompatible" not in robot.diagnosis()[1], "an end of what is no longer so")
        assert "compensated_qos_incompatible" in robot.diagnosis()[1]


def test_every_sample_that_a_full_queue_drops_is_counted(robot, node):
    with node("qos_overrides./accel/raw.subscription.depth:=1"):
        robot.connect()
        robot.raw.publish(SAMPLES[0])
        robot.wait(lambda: robot.compensated, "the first sample, from which on what is missing shows")
        for sample in SAMPLES[1:]:
            robot.raw.publish(sample)
        time.sleep(1.0)
        robot.raw.publish(imu(EPOCH + 10**10, [0.0] * 6))  # what is missing at the end shows by what follows
        robot.wait(lambda: robot.compensated and stamp_of(robot.compensated[-1]) == EPOCH + 10**10, "the last sample")
        values = robot.diagnosis()[2]
    assert int(values["raw_lost_in_transport"]) > 0
    assert int(values["raw_lost_in_transport"]) + int(values["samples_received"]) == len(SAMPLES) + 1
    assert len(robot.compensated) == int(values["samples_received"])
