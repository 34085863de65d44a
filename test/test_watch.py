"""``hgma watch``: the sums, what is shown, and the command beside the real node."""

import io
import json
import subprocess
import sys

import numpy as np
import pytest
from builders import EPOCH, make_calibration
from cli_runs import refused
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from rich.console import Console
from robot import imu, thermistor

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.cli.main import main
from hgma_compensation.cli.watch import FIGURES, WHY_UNKNOWN, live_table
from hgma_compensation.demo.processes import HGMA, running
from hgma_compensation.watching import view
from hgma_compensation.watching.window import Samples, Window

NODE = [sys.executable, "-m", "hgma_compensation.node.main"]
SMALL = st.floats(-1e5, 1e5)


@given(values=arrays(float, st.tuples(st.integers(2, 30), st.just(6)), elements=SMALL), cut=st.integers(0, 30))
def test_sums_are_mean_and_deviation_however_samples_come(values, cut):
    samples = Samples()
    samples.add(values[:cut])
    samples.add(values[cut:])
    np.testing.assert_allclose(samples.mean, values.mean(axis=0), atol=1e-9)
    np.testing.assert_allclose(samples.deviation, values.std(axis=0, ddof=1), rtol=1e-6, atol=1e-2)


def test_a_small_deviation_on_a_large_drift_keeps_its_digits():
    samples, random = Samples(), np.random.default_rng(5)
    values = -52_000.0 + 1e-3 * random.normal(size=(1000, 6))
    samples.add(values)
    np.testing.assert_allclose(samples.deviation, values.std(axis=0, ddof=1), rtol=1e-6)


def test_what_is_not_finite_is_left_out():
    samples = Samples()
    samples.add(np.array([[1.0] * 6, [np.nan, *[1.0] * 5], [3.0] * 6]))
    assert samples.count == 2
    assert samples.mean.tolist() == [2.0] * 6


def test_nothing_is_shown_as_nothing():
    seen = view.figures(Window(), 1.0)
    assert seen["channels"]["linear_acceleration.z"]["raw"] is None
    assert "-> -" in view.line(seen)
    json.dumps(seen, allow_nan=False)


@pytest.mark.ros
@pytest.mark.parametrize("name", ["a b", "1st", "a//b"])
def test_what_is_no_namespace_is_refused(capsys, name):
    assert f"--namespace {name}: give" in refused(capsys, "watch", "--namespace", name)


def test_the_live_table_fits_into_80_columns_and_explains_what_is_not_known():
    seen = view.figures(Window(), 1.0)
    seen["channels"]["linear_acceleration.z"] = {
        **dict.fromkeys(FIGURES, -17770.123),
        "deviation": 6710.1,
        "uncertainty": 3470.1,
    }
    console = Console(width=80, record=True, file=io.StringIO())
    console.print(live_table(seen, "start the driver"))
    text = console.export_text()
    assert "-17 770" in text
    assert WHY_UNKNOWN in text
    assert "start the driver" in text
    rows = [line for line in text.splitlines() if line.startswith(" linear_acceleration")]
    assert len(rows) == 3
    assert all("m/s²" in row for row in rows)


@pytest.mark.ros
def test_watching_the_real_node(environment, robot, tmp_path):
    calibration = make_calibration(channels=("linear_acceleration.z",))
    write_calibration(calibration, tmp_path / "cal.json")
    # Still, at one temperature: whatever samples two means are of, they differ by the drift.
    stamps = EPOCH + np.arange(0, 600_000_000_000, 20_000_000)
    value = [0.0, 0.0, 5000.0, 0.0, 0.0, 0.0]
    watch = [*HGMA, "watch", "--seconds", "3", "--json", str(tmp_path / "seen.json")]
    with running([*NODE, "--ros-args", "-p", f"calibration_file:={tmp_path / 'cal.json'}"], environment, "using"):
        robot.connect()
        process = subprocess.Popen(watch, env=environment, stdout=subprocess.PIPE, text=True)
        for stamp in stamps[:: len(stamps) // 600]:
            robot.temperature.publish(thermistor(stamp, 31.0))
        robot.wait(lambda: robot.node.count_subscribers("/accel/compensated") >= 2, "the watcher")
        waiting = iter(stamps[len(stamps) // 4 :])  # the memory of the temperature's product has settled
        while process.poll() is None:
            robot.raw.publish(imu(next(waiting), value))
            robot.spin(0.02)
        text = process.stdout.read()
    seen = json.loads((tmp_path / "seen.json").read_text())
    assert process.returncode == 0
    assert seen["calibration_id"] == calibration.calibration_id
    assert list(seen["channels"]) == ["linear_acceleration.z"]
    assert seen["raw_rate"] > 1.0
    channel = seen["channels"]["linear_acceleration.z"]
    assert channel["raw"] == pytest.approx(5000.0)
    assert channel["raw"] - channel["compensated"] == pytest.approx(channel["drift"], rel=1e-6)
    assert len(text.splitlines()) == 3


@pytest.mark.ros
def test_silence_names_the_topic_that_speaks(environment, robot):
    # The robot publishes on /accel/raw, which this remapping does not listen to.
    command = [*HGMA, "watch", "--remap", "/accel/raw:=/imu/raw_data"]
    wanted = "nothing comes on /imu/raw_data: start the driver or hgma play; "
    wanted += "sensor_msgs/Imu is on /accel/raw: --remap /accel/raw:=/accel/raw"
    with running(command, {**environment, "PYTHONUNBUFFERED": "1"}, wanted):  # raises where it never says so
        pass


def test_a_wrong_remap_is_refused(capsys):
    assert main(["watch", "--seconds", "1", "--remap", "nonsense"]) == 2
    assert "error: --remap nonsense" in capsys.readouterr().err
