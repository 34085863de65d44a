"""The real node as a process, over DDS."""

import signal
import sys

import numpy as np
import pytest
from builders import LINEAR, make_calibration, make_recording
from effect_calibrations import OFFERED, applied, with_all_inputs
from robot import imu, stamped, thermistor

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.demo.processes import running
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.messages import stamp_of
from hgma_compensation.recording.compensated_bag import compensate_recording
from hgma_msgs.msg import AccelBlock, SupplyVoltage

pytestmark = pytest.mark.ros
NODE = [sys.executable, "-m", "hgma_compensation.node.main"]
RECORDING = make_recording(duration_s=60.0, accel_rate=10.0, thermistor_rate=2.0, cycles=1.0)


@pytest.fixture
def calibrations(tmp_path):
    """Two calibrations with their files, told apart by their ids."""
    both = [make_calibration(seed=1), make_calibration(seed=9)]
    paths = [tmp_path / "first.json", tmp_path / "second.json"]
    for calibration, path in zip(both, paths, strict=True):
        write_calibration(calibration, path)
    return list(zip(both, paths, strict=True))


def node(environment, *parameters, ready="using calibration"):
    words = [word for parameter in parameters for word in ("-p", parameter)]
    return running([*NODE, "--ros-args", *words], environment, ready)


def publish(robot, start, stop):
    """Send the samples from row start to stop with the thermistor samples among them, and wait for the output."""
    del robot.compensated[:], robot.states[:]
    stamps = RECORDING.stamps[start:stop]
    for stamp, celsius in zip(RECORDING.temperature.stamps, RECORDING.temperature.values, strict=True):
        if (start == 0 or stamp > RECORDING.stamps[start - 1]) and stamp <= stamps[-1]:
            robot.temperature.publish(thermistor(stamp, celsius))
    robot.spin(0.2)
    robot.send(robot.raw, map(imu, stamps, RECORDING.values[start:stop]))
    robot.wait(lambda: len(robot.compensated) >= len(stamps) <= len(robot.states), "all samples to come back")


def accelerations(messages):
    return np.array([[m.linear_acceleration.x, m.linear_acceleration.y, m.linear_acceleration.z] for m in messages])


def test_every_sample_comes_back_compensated_with_the_rest_untouched(environment, robot, tmp_path):
    calibration = make_calibration(channels=("linear_acceleration.z",), mode=FilterMode.SMOOTH)
    write_calibration(calibration, tmp_path / "cal.json")
    random = np.random.default_rng(4)
    sent = []
    for stamp, values in zip(RECORDING.stamps, RECORDING.values, strict=True):
        message = imu(stamp, values, frame="link_of_the_imu")
        message.orientation.w, message.orientation.x = random.normal(size=2)
        message.angular_velocity.y = random.normal()
        message.linear_acceleration_covariance = random.uniform(size=9)
        message.orientation_covariance = random.normal(size=9)
        sent.append(message)
    with node(environment, f"calibration_file:={tmp_path / 'cal.json'}"):
        robot.connect()
        for stamp, celsius in zip(RECORDING.temperature.stamps, RECORDING.temperature.values, strict=True):
            robot.temperature.publish(thermistor(stamp, celsius))
        robot.spin(0.5)
        robot.send(robot.raw, sent)
        robot.wait(lambda: len(robot.states) == len(robot.compensated) == len(sent), "all samples")
    expected = compensate_recording(RECORDING, calibration)
    assert [m.linear_acceleration.z for m in robot.compensated] == expected.values[:, 0].tolist()
    assert [list(state.innovation) for state in robot.states] == expected.innovation.tolist()
    assert [state.header for state in robot.states] == [message.header for message in sent]
    for row, (before, after) in enumerate(zip(sent, robot.compensated, strict=True)):
        after.linear_acceleration.z = before.linear_acceleration.z
        if expected.status[row]:
            before.linear_acceleration_covariance[8] += expected.added_variance(row)[0]
        assert after == before


def test_effects_give_what_offline_compensation_gives_and_a_missing_input_is_named(environment, robot, tmp_path):
    random = np.random.default_rng(11)
    wanted = ("thermal_gradient", "supply_voltage", "thermal_lag", "vibration_rectification")
    effects = {effect.name: effect for effect in OFFERED[LINEAR[2]]}
    calibration = make_calibration(effects=[applied(LINEAR[2], effects[name], random) for name in wanted])
    write_calibration(calibration, tmp_path / "effects.json")
    recording = with_all_inputs()
    with node(environment, f"calibration_file:={tmp_path / 'effects.json'}"):
        robot.connect()
        for stamp, celsius in zip(recording.temperature.stamps, recording.temperature.values, strict=True):
            robot.temperature.publish(thermistor(stamp, celsius))
        robot.raw.publish(imu(recording.stamps[0], recording.values[0]))
        robot.wait(lambda: "second thermometer" in robot.diagnosis()[1], "a diagnosis that names what is missing")
        values = robot.diagnosis()[2]
        assert values["missing_inputs"] == "temperature_2, supply_voltage"
        assert values["supply_voltage_missing"] == values["temperature_2_missing"] == "1"
        for stamp, celsius in zip(recording.temperature_2.stamps, recording.temperature_2.values, strict=True):
            robot.temperature_2.publish(thermistor(stamp, celsius))
        for stamp, volts in zip(recording.supply_voltage.stamps, recording.supply_voltage.values, strict=True):
            robot.supply_voltage.publish(stamped(SupplyVoltage(voltage=volts), stamp))
        robot.spin(0.5)
        robot.send(robot.raw, map(imu, recording.stamps[1:], recording.values[1:]))
        robot.wait(lambda: len(robot.states) == len(robot.compensated) == len(recording.stamps), "all samples")
    expected = compensate_recording(recording, calibration)
    np.testing.assert_array_equal(accelerations(robot.compensated), expected.values)
    assert [list(state.drift) for state in robot.states] == expected.drift.tolist()


def test_a_wrong_calibration_is_refused_with_its_reason_and_the_stream_goes_on(
    environment, robot, calibrations, tmp_path
):
    (first, first_path), (second, second_path) = calibrations
    damaged = tmp_path / "damaged.json"
    damaged.write_text(second_path.read_text().replace('"seed": 9', '"seed": 8'))
    with node(environment, f"calibration_file:={first_path}"):
        robot.connect()
        publish(robot, 0, 100)
        result = robot.set_parameter("calibration_file", str(damaged))
        assert not result.successful
        assert "calibration_id" in result.reason
        assert str(damaged) in result.reason
        answer = robot.load(tmp_path / "missing.json")
        assert not answer.success
        assert "missing.json" in answer.message
        assert answer.calibration_id == answer.previous_calibration_id == first.calibration_id
        publish(robot, 100, 200)
        assert {state.calibration_id for state in robot.states} == {first.calibration_id}
        expected = compensate_recording(RECORDING, first).values[100:200]
        np.testing.assert_array_equal(accelerations(robot.compensated), expected)
        level, message, _ = robot.diagnosis()
        assert level == b"\x01"
        assert "missing.json" in message
        assert robot.set_parameter("calibration_file", str(second_path)).successful
        publish(robot, 200, 300)
        assert {state.calibration_id for state in robot.states} == {second.calibration_id}
        answer = robot.load(first_path)
        assert (answer.success, answer.previous_calibration_id) == (True, second.calibration_id)
        assert answer.calibration_id == first.calibration_id


def test_blocks_are_compensated_like_the_samples_in_them(environment, robot, calibrations):
    (calibration, path), _ = calibrations
    axes = RECORDING.values[:, :3].astype(np.float32)
    with node(environment, f"calibration_file:={path}"):
        robot.connect()
        for stamp, celsius in zip(RECORDING.temperature.stamps, RECORDING.temperature.values, strict=True):
            robot.temperature.publish(thermistor(stamp, celsius))
        robot.spin(0.5)
        for start in range(0, len(axes), 100):
            x, y, z = axes[start : start + 100].T.copy()
            block = AccelBlock(sample_interval=0.1, x=x, y=y, z=z)
            robot.raw_block.publish(stamped(block, RECORDING.stamps[start]))
        uneven = AccelBlock(sample_interval=0.1, x=[1.0], y=[], z=[1.0])
        robot.raw_block.publish(stamped(uneven, RECORDING.stamps[-1]))
        robot.wait(lambda: len(robot.blocks) == 6, "six blocks")
        _, message, values = robot.diagnosis()
        assert values["block_malformed"] == "1"
        assert "check the driver" in message
    values = np.zeros_like(RECORDING.values)
    values[:, :3] = axes
    expected = compensate_recording(type(RECORDING)(**{**RECORDING.__dict__, "values": values}), calibration)
    received = np.concatenate([np.array([b.x, b.y, b.z]).T for b in robot.blocks])
    np.testing.assert_array_equal(received.astype(np.float32), expected.values.astype(np.float32))
    assert [stamp_of(block) for block in robot.blocks] == RECORDING.stamps[::100].tolist()


def test_diagnostics_count_what_is_skipped_and_say_what_to_do(environment, robot, calibrations):
    _, path = calibrations[0]
    with node(environment, f"calibration_file:={path}"):
        robot.connect()
        publish(robot, 0, 5)
        robot.raw.publish(imu(RECORDING.stamps[5], [np.nan] * 6))
        robot.temperature.publish(thermistor(RECORDING.stamps[5], np.nan))
        robot.wait(lambda: "not_finite" in robot.diagnosis()[1], "a diagnosis that names NaN")
        _, _, values = robot.diagnosis()
        assert values["samples_received"] == "6"
        assert values["samples_compensated"] == "5"
        assert values["samples_skipped"] == values["acceleration_not_finite"] == "1"
        assert values["temperature_not_finite"] == "1"
        assert float(values["stamp_age_seconds"]) > 0.0
        assert len(robot.compensated) == 5
        assert robot.reset().success
        _, _, values = robot.diagnosis()
        assert values["calibration_id"] == calibrations[0][0].calibration_id


def test_without_a_calibration_it_waits_and_says_so(environment, robot, calibrations):
    calibration, path = calibrations[0]
    with node(environment, ready="no calibration yet"):
        robot.connect()
        robot.raw.publish(imu(RECORDING.stamps[0], RECORDING.values[0]))
        robot.wait(lambda: robot.diagnosis()[2].get("no_calibration") == "1", "the skipped sample in the diagnostics")
        level, message, _ = robot.diagnosis()
        assert level == b"\x02"
        assert "calibration_file" in message
        assert not robot.compensated
        assert robot.load(path).calibration_id == calibration.calibration_id
        publish(robot, 0, 10)


def test_a_refused_file_at_the_start_leaves_it_unconfigured_until_a_good_one_is_set(
    environment, robot, calibrations, tmp_path
):
    _, path = calibrations[0]
    with node(environment, f"calibration_file:={tmp_path / 'none.json'}", ready="none.json"):
        assert robot.lifecycle() == "unconfigured"
        level, message, _ = robot.diagnosis()
        assert level == b"\x02"
        assert "none.json" in message
        assert robot.set_parameter("calibration_file", str(path)).successful
        assert robot.lifecycle() == "active"
        robot.connect()
        publish(robot, 0, 10)


def test_a_lifecycle_manager_decides_when_there_is_output(environment, robot, calibrations):
    _, path = calibrations[0]
    with node(environment, "autostart:=false", f"calibration_file:={path}", ready="waiting to be configured"):
        assert robot.lifecycle() == "unconfigured"
        assert robot.change_state("configure")
        robot.connect()
        robot.raw.publish(imu(RECORDING.stamps[0], RECORDING.values[0]))
        robot.wait(lambda: robot.diagnosis()[2].get("node_not_active") == "1", "the skipped sample")
        assert not robot.compensated
        assert robot.change_state("activate")
        publish(robot, 0, 10)
        assert robot.change_state("deactivate")
        assert robot.change_state("cleanup")
        assert robot.lifecycle() == "unconfigured"
        assert robot.change_state("configure")
        assert robot.change_state("activate")
        robot.connect()
        publish(robot, 0, 10)
        assert robot.change_state("deactivate")
        assert robot.change_state("shutdown")
        assert robot.lifecycle() == "finalized"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signals_end_it_cleanly(environment, calibrations, number):
    with node(environment, f"calibration_file:={calibrations[0][1]}") as process:
        process.send_signal(number)
        assert process.wait(20.0) == 0
