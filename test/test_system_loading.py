"""Calibrations loaded into the real node while samples stream through it."""

import json
import os
import signal
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from builders import make_calibration, make_recording
from children import only_child_of, wait_until_gone
from rcl_interfaces.srv import DescribeParameters
from robot import imu, thermistor

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.demo.processes import running
from hgma_compensation.recording.compensated_bag import compensate_recording
from hgma_msgs.srv import LoadCalibration

pytestmark = pytest.mark.ros
NODE = [sys.executable, "-m", "hgma_compensation.node.main"]
ROOT = Path(__file__).parent.parent
RECORDING = make_recording(duration_s=60.0, accel_rate=10.0, thermistor_rate=2.0, cycles=1.0)
IMPATIENT = """
import sys
from hgma_compensation.loading import process
from hgma_compensation.node import main
process.PATIENCE = 1.0
sys.exit(main.main())
"""


@pytest.fixture
def calibrations(tmp_path):
    """Three calibrations by the path of their files, in a directory of their own."""
    (tmp_path / "calibrations").mkdir()
    made = {tmp_path / "calibrations" / f"{seed}.json": make_calibration(seed=seed) for seed in (1, 9, 17)}
    for path, calibration in made.items():
        write_calibration(calibration, path)
    return made


def node(environment, *parameters, command=NODE):
    words = [word for parameter in parameters for word in ("-p", parameter)]
    return running([*command, "--ros-args", *words], environment, "using calibration")


def begin(robot):
    """Connect and send the thermistor's samples, all of them before any acceleration."""
    robot.connect()
    for stamp, celsius in zip(RECORDING.temperature.stamps, RECORDING.temperature.values, strict=True):
        robot.temperature.publish(thermistor(stamp, celsius))
    robot.spin(0.3)


def publish(robot, start, stop):
    robot.send(robot.raw, map(imu, RECORDING.stamps[start:stop], RECORDING.values[start:stop]))


def check(robot, calibrations, count):
    """Wait for all outputs and compare each with what the calibration of its state gives; return their ids."""
    robot.wait(lambda: len(robot.compensated) >= count <= len(robot.states), "all samples")
    expected = {c.calibration_id: compensate_recording(RECORDING, c).values for c in calibrations.values()}
    ids = [state.calibration_id for state in robot.states]
    assert [m.header for m in robot.compensated] == [state.header for state in robot.states]
    outputs = [[m.linear_acceleration.x, m.linear_acceleration.y, m.linear_acceleration.z] for m in robot.compensated]
    wanted = [expected[calibration_id][row] for row, calibration_id in enumerate(ids)]
    np.testing.assert_array_equal(outputs, wanted)
    assert len(outputs) == count
    return ids


def test_each_sample_belongs_to_one_calibration_while_they_are_swapped_by_service_and_parameter(
    environment, robot, calibrations
):
    paths, row = list(calibrations), 0
    with node(environment, f"calibration_file:={paths[0]}"):
        begin(robot)
        client = robot.client(LoadCalibration, "/compensation_node/load_calibration")
        robot.wait(client.service_is_ready, "the service")
        for number in range(1, 13):
            path = paths[number % 3]
            publish(robot, row, row + 20)
            if number % 2:
                future = client.call_async(LoadCalibration.Request(path=str(path)))
                publish(robot, row + 20, row + 40)
                robot.wait(future.done, "an answer")
                assert future.result().calibration_id == calibrations[path].calibration_id
            else:
                assert robot.set_parameter("calibration_file", str(path)).successful
                publish(robot, row + 20, row + 40)
            row += 40
        ids = check(robot, calibrations, row)
    changes = [ids[0]] + [after for before, after in pairwise(ids) if before != after]
    wanted = [calibrations[paths[number % 3]].calibration_id for number in range(13)]
    assert changes == wanted[: len(changes)]
    assert set(ids[-20:]) == {wanted[-1]}


def test_the_stream_goes_on_while_a_file_is_read_and_requests_are_answered_in_turn(environment, robot, calibrations):
    first, second, third = calibrations
    with node(environment, f"calibration_file:={first}") as process:
        begin(robot)
        loading = only_child_of(process.pid)
        os.kill(loading, signal.SIGSTOP)
        client = robot.client(LoadCalibration, "/compensation_node/load_calibration")
        robot.wait(client.service_is_ready, "the service")
        answers = [client.call_async(LoadCalibration.Request(path=str(path))) for path in (second, third)]
        publish(robot, 0, 100)
        assert set(check(robot, calibrations, 100)) == {calibrations[first].calibration_id}
        assert not any(answer.done() for answer in answers)
        os.kill(loading, signal.SIGCONT)
        robot.wait(lambda: all(answer.done() for answer in answers), "both answers")
        chain = [calibrations[path].calibration_id for path in calibrations]
        assert [a.result().previous_calibration_id for a in answers] == chain[:2]
        assert [a.result().calibration_id for a in answers] == chain[1:]
        publish(robot, 100, 120)
        assert set(check(robot, calibrations, 120)[100:]) == {chain[2]}


def test_a_file_that_hangs_is_refused_in_time_and_the_next_one_is_loaded(environment, robot, calibrations):
    first, second, third = calibrations
    with node(environment, f"calibration_file:={first}", command=[sys.executable, "-c", IMPATIENT]) as process:
        begin(robot)
        loading = only_child_of(process.pid)
        os.kill(loading, signal.SIGSTOP)
        client = robot.client(LoadCalibration, "/compensation_node/load_calibration")
        robot.wait(client.service_is_ready, "the service")
        hanging = client.call_async(LoadCalibration.Request(path=str(second)))
        publish(robot, 0, 100)
        assert set(check(robot, calibrations, 100)) == {calibrations[first].calibration_id}
        robot.wait(hanging.done, "an answer")
        assert not hanging.result().success
        assert f"{second}: not done within 1 s: check the disk or network" in hanging.result().message
        wait_until_gone(loading)
        assert robot.load(third).success
        publish(robot, 100, 120)
        assert set(check(robot, calibrations, 120)[100:]) == {calibrations[third].calibration_id}


def test_a_loading_process_that_is_killed_costs_neither_samples_nor_the_request(environment, robot, calibrations):
    first, second, _ = calibrations
    with node(environment, f"calibration_file:={first}") as process:
        begin(robot)
        loading = only_child_of(process.pid)
        os.kill(loading, signal.SIGSTOP)
        client = robot.client(LoadCalibration, "/compensation_node/load_calibration")
        robot.wait(client.service_is_ready, "the service")
        answer = client.call_async(LoadCalibration.Request(path=str(second)))
        publish(robot, 0, 50)
        check(robot, calibrations, 50)
        os.kill(loading, signal.SIGKILL)
        robot.wait(answer.done, "an answer")
        assert answer.result().success
        publish(robot, 50, 70)
        assert set(check(robot, calibrations, 70)[50:]) == {calibrations[second].calibration_id}


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_a_node_that_ends_leaves_no_process_behind(environment, calibrations, number):
    command = [*NODE, "--ros-args", "-p", f"calibration_file:={next(iter(calibrations))}"]
    with subprocess.Popen(
        command, env=environment, stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as process:
        assert any("using calibration" in line for line in process.stderr)
        loading = only_child_of(process.pid)
        if number == signal.SIGINT:
            os.killpg(process.pid, number)  # as a terminal does
        else:
            process.send_signal(number)
        assert "Traceback" not in process.stderr.read()
    wait_until_gone(loading)


def test_what_is_refused_changes_nothing_and_says_why_in_one_line(environment, robot, calibrations, tmp_path):
    first, second, _ = calibrations
    inside = first.parent
    write_calibration(make_calibration(seed=3, sensor_id="another"), inside / "other.json")
    (inside / "truncated.json").write_bytes(second.read_bytes()[:1000])
    os.replace(second, tmp_path / "outside.json")
    (inside / "link.json").symlink_to(tmp_path / "outside.json")
    os.mkfifo(inside / "pipe.json")
    refusals = {
        inside / "other.json": "sensor_id is 'another', expected_sensor_id is 'imu_link'",
        inside / "truncated.json": "is not complete JSON",
        tmp_path / "outside.json": "outside of the calibration directory",
        inside / "link.json": "outside of the calibration directory",
        inside / "pipe.json": "is not a regular file",
        Path("/dev/zero"): "is not a regular file",
        inside: "is not a regular file",
        inside / "missing.json": "cannot be opened (No such file or directory)",
        inside / ("x" * 300): "cannot be opened (File name too long)",
        Path("~/sensor.json"): "where ~ is not expanded",
        "": "must be the path of a calibration file",
    }
    constraints = (f"calibration_directory:={inside}", "expected_sensor_id:=imu_link")
    with node(environment, f"calibration_file:={first}", *constraints):
        begin(robot)
        for number, (path, reason) in enumerate(refusals.items()):
            publish(robot, 10 * number, 10 * number + 10)
            answer, result = robot.load(path), robot.set_parameter("calibration_file", str(path))
            assert not answer.success
            assert not result.successful
            assert answer.calibration_id == answer.previous_calibration_id == calibrations[first].calibration_id
            assert reason in answer.message
            assert reason in result.reason
            assert "\n" not in answer.message
        assert not robot.set_parameter("calibration_file", 7).successful
        for name in ("calibration_directory", "expected_sensor_id"):
            result = robot.set_parameter(name, "")
            assert not result.successful
            assert "read-only" in result.reason
        described = robot.call(
            DescribeParameters, "describe_parameters", names=["calibration_directory", "expected_sensor_id"]
        )
        assert all(descriptor.read_only and descriptor.description for descriptor in described.descriptors)
        ids = check(robot, calibrations, 10 * len(refusals))
    assert set(ids) == {calibrations[first].calibration_id}


def test_a_short_soak_finds_no_fault():
    command = [sys.executable, "-m", "benchmarks.soak.reloads", "--count", "40", "--rate", "500", "--quiet", "0.5"]
    run = subprocess.run([*command, "--reliable"], cwd=ROOT, stdout=subprocess.PIPE, text=True, timeout=120.0)
    figures = json.loads(run.stdout)
    assert figures["loaded"] == 40
    assert figures["refused"] == 4
    assert figures["outputs"] == figures["sent"] > 100
    assert not any(figures["faults"].values())
    assert run.returncode == 0
