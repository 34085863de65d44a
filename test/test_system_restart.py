"""The real node, killed and started again."""

import sys
from contextlib import contextmanager, suppress

import numpy as np
import pytest
from builders import LINEAR, make_calibration
from effect_calibrations import OFFERED, applied, with_all_inputs
from robot import Robot, imu, stamped, thermistor

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.demo.processes import running
from hgma_compensation.errors import RefusedError
from hgma_compensation.pipeline.state_file import read_state
from hgma_compensation.recording.compensated_bag import compensate_recording
from hgma_msgs.msg import SupplyVoltage

pytestmark = pytest.mark.ros
RECORDING = with_all_inputs()
HALF, ROWS = len(RECORDING.stamps) // 2, len(RECORDING.stamps)
WANTED = ("thermal_lag", "stress_relaxation", "warm_up", "hysteresis", "vibration_rectification", "supply_voltage")


def calibration_with_memories(seed=1):
    effects = {effect.name: effect for effect in OFFERED[LINEAR[2]]}
    random = np.random.default_rng(11)
    return make_calibration(seed, effects=[applied(LINEAR[2], effects[name], random) for name in WANTED])


CALIBRATION = calibration_with_memories()


@pytest.fixture
def files(tmp_path):
    """A calibration's file and the path of a state file in a folder of its own."""
    write_calibration(CALIBRATION, tmp_path / "calibration.json")
    (tmp_path / "states").mkdir()
    return tmp_path / "calibration.json", tmp_path / "states" / "state.json"


@contextmanager
def node(environment, files, *parameters, ready="using calibration"):
    settings = [f"calibration_file:={files[0]}", f"state_file:={files[1]}", "state_period:=1.0", *parameters]
    words = [word for parameter in settings for word in ("-p", parameter)]
    command = [sys.executable, "-m", "hgma_compensation.node.main", "--ros-args", *words]
    with running(command, environment, ready) as process:
        yield process


@contextmanager
def robot_of(environment):
    """Return a peer that begins here: to an older one the topics of a killed node are there for another 20 s."""
    peer = Robot(int(environment["ROS_DOMAIN_ID"]))
    try:
        yield peer
    finally:
        peer.close()


@contextmanager
def killed(environment, files):
    """Run the node, with a peer of its own, until the block ends; then kill -9."""
    with suppress(RuntimeError), robot_of(environment) as peer, node(environment, files) as process:
        yield peer
        process.kill()
        process.wait()


def stream(robot, start, stop):
    """Send the rows from start to stop, with the slow samples among them, and return the accelerations that come."""
    del robot.compensated[:], robot.states[:]
    robot.connect()
    after, until = RECORDING.stamps[start - 1] if start else 0, RECORDING.stamps[stop - 1]
    for publisher, series, make in (
        (robot.temperature, RECORDING.temperature, thermistor),
        (robot.supply_voltage, RECORDING.supply_voltage, lambda s, v: stamped(SupplyVoltage(voltage=v), s)),
    ):
        for stamp, value in zip(series.stamps.tolist(), series.values.tolist(), strict=True):
            if after < stamp <= until:
                publisher.publish(make(stamp, value))
    robot.spin(0.3)
    robot.send(robot.raw, map(imu, RECORDING.stamps[start:stop], RECORDING.values[start:stop]))
    robot.wait(lambda: len(robot.states) == len(robot.compensated) == stop - start, "all samples")
    return np.array(
        [[m.linear_acceleration.x, m.linear_acceleration.y, m.linear_acceleration.z] for m in robot.compensated]
    )


def wait_until_saved(robot, path, newest):
    """Wait until the file holds the state after a row."""

    def saved():
        with suppress(RefusedError):
            state = read_state(path)
            return state is not None and state.acceleration == RECORDING.stamps[newest]

    robot.wait(saved, "the state to be saved")


def test_killed_and_started_again_it_goes_on_bit_for_bit(environment, files):
    expected = compensate_recording(RECORDING, CALIBRATION).values
    with killed(environment, files) as doomed:
        np.testing.assert_array_equal(stream(doomed, 0, HALF), expected[:HALF])
        wait_until_saved(doomed, files[1], HALF - 1)
        level, message, values = doomed.diagnosis()
        assert level == b"\x01"
        assert "settling, the memory began without a past: stress_relaxation" in message
        assert values["memory"] == "none"
        assert int(values["state_bytes"]) == files[1].stat().st_size
    litter = files[1].parent / f".{files[1].name}.abcd1234"
    litter.touch()
    with robot_of(environment) as robot, node(environment, files):
        np.testing.assert_array_equal(stream(robot, HALF, ROWS - 10), expected[HALF : ROWS - 10])
        assert not litter.exists()
        assert robot.diagnosis()[2]["memory"] == "taken_up"
    # A clean end saves at once.
    assert read_state(files[1]).acceleration == RECORDING.stamps[ROWS - 11]
    with robot_of(environment) as robot, node(environment, files):
        np.testing.assert_array_equal(stream(robot, ROWS - 10, ROWS), expected[ROWS - 10 :])


def test_after_a_reset_a_restart_brings_nothing_back(environment, files):
    with killed(environment, files) as doomed:
        stream(doomed, 0, 50)
        wait_until_saved(doomed, files[1], 49)
        assert doomed.reset().message.endswith("state file removed")
        assert not files[1].exists()
    with robot_of(environment) as robot, node(environment, files, ready="not there yet"):
        stream(robot, 50, 60)
        assert robot.diagnosis()[2]["memory"] == "none"


def test_a_state_that_is_too_old_is_dropped_and_said(environment, robot, files):
    with node(environment, files):
        stream(robot, 0, 50)
    with node(environment, files, "state_max_age:=2.0"):
        stream(robot, 100, 110)
        values = robot.diagnosis()[2]
        assert values["memory"] == "state_too_old"
        assert values["state_too_old"] == "1"
        assert "stress_relaxation" in values["settling"]


def test_another_calibration_replays_the_samples_and_keeps_the_lifecycle_states_memory(environment, robot, files):
    other = calibration_with_memories(seed=9)
    with node(environment, files):
        stream(robot, 0, HALF)
    write_calibration(other, files[0])
    with node(environment, files):
        stream(robot, HALF, HALF + 10)
        assert robot.diagnosis()[2]["memory"] == "replayed"
        for transition in ("deactivate", "cleanup", "configure", "activate"):
            assert robot.change_state(transition)
        stream(robot, HALF + 10, HALF + 20)
        assert robot.diagnosis()[2]["memory"] == "taken_up"


def test_a_folder_that_cannot_be_written_is_said_and_the_stream_goes_on(environment, robot, files):
    calibration, state = files
    state.parent.rmdir()
    state.parent.write_text("a file where the folder should be")
    expected = compensate_recording(RECORDING, CALIBRATION).values
    with node(environment, files):
        np.testing.assert_array_equal(stream(robot, 0, 50), expected[:50])
        robot.wait(lambda: "cannot be written (Not a directory)" in robot.diagnosis()[1], "the problem")
        level, message, values = robot.diagnosis()
        assert level == b"\x01"
        assert "the memory is not kept, a restart would lose it" in message
        assert int(values["state_save_failures"]) >= 1
        state.parent.unlink()
        state.parent.mkdir()
        robot.wait(lambda: "not kept" not in robot.diagnosis()[1], "the problem to go")
        np.testing.assert_array_equal(stream(robot, 50, 100), expected[50:100])
    assert calibration.exists()
    assert read_state(state).acceleration == RECORDING.stamps[99]


def test_a_damaged_state_is_said_and_the_node_starts_without_it(environment, robot, files):
    files[1].write_bytes(b'{"format":"hgma_state","version":1')
    with node(environment, files, ready="the node starts without it"):
        robot.wait(lambda: str(files[1]) in robot.diagnosis()[1], "the refusal")
        stream(robot, 0, 50)
        wait_until_saved(robot, files[1], 49)
        robot.wait(lambda: str(files[1]) not in robot.diagnosis()[1], "the refusal to be forgotten")
