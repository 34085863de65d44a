"""What a diagnosis writes, run by the real node: before and after, live and offline."""

import sys

import numpy as np
import pytest
from diagnosis_blocks import RATE, diagnosis_of_days, lagging_days, trained_before
from robot import imu, thermistor

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.demo.processes import running
from hgma_compensation.recording.compensated_bag import compensate_recording

pytestmark = pytest.mark.ros
NODE = [sys.executable, "-m", "hgma_compensation.node.main"]
PLAYED = int(200 * RATE)
"""Samples of the third day that are played: a soak, a corner and the ramp after it."""


@pytest.fixture
def files(tmp_path):
    paths = tmp_path / "before.json", tmp_path / "after.json"
    for calibration, path in zip((trained_before(), diagnosis_of_days().calibration), paths, strict=True):
        write_calibration(calibration, path)
    return paths


def played(robot, recording):
    """Send the samples and return the compensated z (n,) with the calibrations that they were made with."""
    del robot.compensated[:], robot.states[:]
    robot.send(robot.raw, map(imu, recording.stamps[:PLAYED], recording.values[:PLAYED]))
    robot.wait(lambda: len(robot.compensated) == len(robot.states) == PLAYED, "all samples to come back")
    assert [message.header.stamp for message in robot.compensated] == [state.header.stamp for state in robot.states]
    live = np.array([message.linear_acceleration.z for message in robot.compensated])
    return live, {state.calibration_id for state in robot.states}


def rms(values, reference):
    return float(np.sqrt(np.mean((values.reshape(-1, 20).mean(axis=1) - reference) ** 2)))


def test_the_augmented_calibration_runs_in_the_node_and_the_error_falls_as_offline(environment, robot, files):
    diagnosis, recording = diagnosis_of_days(), lagging_days()[2]
    calibrations = trained_before(), diagnosis.calibration
    assert [applied.effect.name for applied in calibrations[1].effects] == ["thermal_lag"]
    words = ["--ros-args", "-p", f"calibration_file:={files[0]}"]
    errors = {"live": [], "offline": []}
    with running([*NODE, *words], environment, "using calibration"):
        robot.connect()
        inside = recording.temperature.stamps <= recording.stamps[PLAYED]
        series = recording.temperature.stamps[inside], recording.temperature.values[inside]
        for calibration, path in zip(calibrations, files, strict=True):
            assert robot.set_parameter("calibration_file", str(path)).successful
            for stamp, celsius in zip(*series, strict=True):
                robot.temperature.publish(thermistor(stamp, celsius))
            robot.spin(0.5)
            live, identities = played(robot, recording)
            offline = compensate_recording(recording, calibration).values[:PLAYED, 0]
            assert identities == {calibration.calibration_id}
            np.testing.assert_array_equal(live, offline)
            reference = calibration.channels[0].reference
            errors["live"].append(rms(live, reference))
            errors["offline"].append(rms(offline, reference))
        values = robot.diagnosis()[2]
        assert values.get("temperature_late", "0") == "0"
        assert values["samples_compensated"] == str(2 * PLAYED)
    assert errors["live"] == errors["offline"]
    before, after = errors["live"]
    assert after < 0.1 * before
    # As the diagnosis said of the whole day.
    said = diagnosis.channels[0]
    assert after == pytest.approx(said.error_after, rel=0.5)
    assert before == pytest.approx(said.error_before, rel=0.5)
