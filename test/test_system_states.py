"""The state topic of the real node: bounded, and prompt where something changes."""

import sys

import numpy as np
import pytest
from builders import EPOCH, make_calibration
from robot import imu, stamped, thermistor

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.demo.processes import running
from hgma_compensation.messages import stamp_of
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.live_samples import single_sample
from hgma_compensation.pipeline.state_rate import StateRate
from hgma_msgs.msg import AccelBlock

pytestmark = pytest.mark.ros
MILLISECOND = 1_000_000
COUNT = 2000
CALIBRATION = make_calibration()


@pytest.fixture
def node(environment, tmp_path):
    """Return a function that runs the node with a calibration and further parameters."""
    write_calibration(CALIBRATION, tmp_path / "cal.json")

    def run(*parameters):
        given = (f"calibration_file:={tmp_path / 'cal.json'}", *parameters)
        words = [word for parameter in given for word in ("-p", parameter)]
        command = [sys.executable, "-m", "hgma_compensation.node.main", "--ros-args", *words]
        return running(command, environment, "using calibration")

    return run


def temperatures():
    """Return samples of the thermistor (ns, °C), the last of them 9 s before the first acceleration."""
    return [(EPOCH + second * 1000 * MILLISECOND, 25.0 + 0.01 * (second % 3)) for second in range(-40, -8)]


def samples():
    """Return a second at 1 kHz with the temperature known, and one in which the thermistor has been silent too long."""
    return [imu(EPOCH + number * MILLISECOND, [0.001 * number] * 6) for number in range(COUNT)]


def warm(robot):
    for stamp, celsius in temperatures():
        robot.temperature.publish(thermistor(stamp, celsius))
    robot.spin(0.3)


def expected():
    """Return stamps, statuses and ranges of all samples, one after the other."""
    live = LiveCompensation()
    live.install(CALIBRATION)
    for stamp, celsius in temperatures():
        live.add_temperature(stamp, celsius)
    results = [live.compensate(*single_sample(stamp_of(m), [m.linear_acceleration.x] * 6)) for m in samples()]
    columns = [(r.compensated.status[0], r.compensated.inside_range[0]) for r in results]
    return np.array([stamp_of(m) for m in samples()]), *(np.array(column) for column in zip(*columns, strict=True))


def test_by_default_states_are_bounded_and_those_that_the_rate_chooses(robot, node):
    stamps, status, inside = expected()
    assert len(set(status.tolist())) == 2  # the thermistor goes stale on the way
    chosen = stamps[StateRate().choose(stamps, status, inside)].tolist()
    change = int(stamps[np.flatnonzero(np.diff(status))[0] + 1])
    with node():
        robot.connect()
        warm(robot)
        robot.send(robot.raw, samples())
        robot.wait(lambda: len(robot.compensated) == COUNT, "all samples")
        robot.wait(lambda: len(robot.states) >= len(chosen), "the states")
        robot.spin(0.2)
    assert [stamp_of(state) for state in robot.states] == chosen
    assert change in chosen
    assert len(chosen) <= 20 * COUNT // 1000 + 2
    assert [state.temperature_status for state in robot.states] == status[np.isin(stamps, chosen)].tolist()


def test_rate_0_gives_a_state_with_every_sample_and_a_reset_or_calibration_one_at_once(robot, node, tmp_path):
    with node("state_rate:=0.0"):
        robot.connect()
        warm(robot)
        robot.send(robot.raw, samples()[:200])
        robot.wait(lambda: len(robot.compensated) == len(robot.states) == 200, "a state for each")
    with node("state_rate:=0.001"):
        robot.connect()
        warm(robot)
        del robot.states[:]
        for number, happens in enumerate((None, None, robot.reset, lambda: robot.load(tmp_path / "cal.json"), None)):
            if happens is not None:
                assert happens().success
                warm(robot)
            robot.raw.publish(samples()[number])
            robot.spin(0.2)
        robot.raw.publish(imu(EPOCH + 5 * MILLISECOND, [1.0] * 6, frame="other"))
        robot.wait(lambda: len(robot.states) == 4, "the states")
        robot.spin(0.2)
    assert [(stamp_of(state) - EPOCH) // MILLISECOND for state in robot.states] == [0, 2, 3, 5]


def test_a_block_counts_as_its_last_sample(robot, node):
    with node():
        robot.connect()
        warm(robot)
        for number in range(20):
            block = AccelBlock(sample_interval=0.001, x=[1.0] * 10, y=[1.0] * 10, z=[1.0] * 10)
            robot.raw_block.publish(stamped(block, EPOCH + number * 10 * MILLISECOND))
        robot.wait(lambda: len(robot.blocks) == 20, "all blocks")
        robot.wait(lambda: len(robot.states) == 4, "the states")
        robot.spin(0.2)
    assert [(stamp_of(state) - EPOCH) // MILLISECOND for state in robot.states] == [0, 50, 100, 150]
