"""Tables of autopilots' logs, with the header lines that their exporters write."""

import json

import numpy as np
import pytest
from autopilots import ground_station, px4_offset
from cli_runs import refused, run

from hgma_compensation.migration.presets import PRESETS
from hgma_compensation.recording.bag_reader import read_recording

PX4_ACCEL = (
    "timestamp,timestamp_sample,device_id,x,y,z,temperature,error_count,is_external,"
    "clip_counter[0],clip_counter[1],clip_counter[2],samples"
)
"""PX4/PX4-Autopilot msg/SensorAccel.msg, written by PX4/pyulog pyulog/ulog2csv.py: timestamp first."""

PX4_GYRO = (
    "timestamp,timestamp_sample,device_id,temperature,scale,dynamic_range,error_count,"
    "clip_counter[0],clip_counter[1],clip_counter[2],samples,x,y,z"
)
"""PX4/PX4-Autopilot msg/SensorGyro.msg."""

ARDUPILOT = "timestamp,TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,EA,T,GH,AH,GHz,AHz"
"""ArduPilot/ardupilot libraries/AP_InertialSensor/LogStructure.h, after the column that mavlogdump.py puts first."""

COEFFICIENTS = np.array([[0.02, 1e-3, 2e-5, 1e-7], [-0.05, -2e-3, 1e-5, -2e-7], [0.1, 3e-3, -4e-5, 3e-7]])
STILL = np.array([0.0, 0.0, -9.80665])


def oven(rows=3000, seed=1):
    """Return time, s, temperature, °C, and acceleration (n, 3), m/s², of cubics about 30 °C with noise."""
    random = np.random.default_rng(seed)
    time = 12.5 + 0.4 * np.arange(rows)
    temperature = 30.0 - 30.0 * np.cos(2.0 * np.pi * 1.5 * (time - time[0]) / np.ptp(time))
    drift = np.polynomial.polynomial.polyval(temperature - 30.0, COEFFICIENTS.T).T
    return time, temperature, STILL + drift + 0.002 * random.standard_normal((rows, 3))


def write(path, header, columns):
    """Write a table: arrays by header name; every other column is 0."""
    names = header.split(",")
    rows = len(next(iter(columns.values())))
    cells = [[repr(value) for value in np.asarray(columns.get(name, np.zeros(rows, int))).tolist()] for name in names]
    path.write_text("\n".join([header, *(",".join(row) for row in zip(*cells, strict=True))]) + "\n")
    return path


def px4_table(path, header=PX4_ACCEL, rows=3000):
    time, temperature, values = oven(rows)
    sampled = np.rint(time * 1e6).astype(np.int64)
    axes = dict(zip("xyz", values.T, strict=True))
    columns = {"timestamp": sampled + 350, "timestamp_sample": sampled, "temperature": temperature, **axes}
    return write(path, header, columns), time, temperature, values


def ardupilot_table(path, sensors=(0,), rows=60):
    time, temperature, values = oven(rows)
    count = len(sensors)
    number = np.tile(sensors, rows)
    columns = {
        "timestamp": 1.6e9 + np.repeat(time, count),
        "TimeUS": np.repeat(np.rint(time * 1e6).astype(np.int64), count) + 17 * number,
        "I": number,
        "T": np.repeat(temperature, count) + number,
        **{f"Acc{axis}": np.repeat(v, count) + number for axis, v in zip("XYZ", values.T, strict=True)},
        **{f"Gyr{axis}": 0.001 * np.repeat(v, count) + number for axis, v in zip("XYZ", values.T, strict=True)},
    }
    return write(path, ARDUPILOT, columns), time, temperature, values


def test_an_accelerometer_of_px4(tmp_path):
    table, time, temperature, values = px4_table(tmp_path / "log_sensor_accel_0.csv", rows=50)
    assert run("import-csv", table, "-o", tmp_path / "bag", "--preset", "px4-ulog", "--json", tmp_path / "j") == 0
    recording = read_recording(tmp_path / "bag")
    np.testing.assert_array_equal(recording.stamps, np.rint(time * 1e9).astype(np.int64))
    np.testing.assert_array_equal(recording.values[:, :3], values)
    np.testing.assert_array_equal(recording.temperature.values, temperature)
    assert json.loads((tmp_path / "j").read_text())["channels"] == [f"linear_acceleration.{axis}" for axis in "xyz"]


def test_a_gyroscope_of_px4(tmp_path):
    table, _, _, values = px4_table(tmp_path / "log_sensor_gyro_0.csv", PX4_GYRO, rows=50)
    assert run("import-csv", table, "-o", tmp_path / "bag", "--preset", "px4-ulog-gyro") == 0
    recording = read_recording(tmp_path / "bag")
    np.testing.assert_array_equal(recording.values[:, 3:], values)
    assert recording.present == tuple(f"angular_velocity.{axis}" for axis in "xyz")


@pytest.mark.parametrize("sensor", [0, 2])
def test_one_sensor_of_ardupilot_among_several(tmp_path, sensor):
    table, time, temperature, values = ardupilot_table(tmp_path / "imu.csv", (0, 1, 2))
    words = [] if sensor == 0 else ["--sensor", sensor]
    assert run("import-csv", table, "-o", tmp_path / "bag", "--preset", "ardupilot-imu", *words) == 0
    recording = read_recording(tmp_path / "bag")
    np.testing.assert_array_equal(recording.stamps, (np.rint(time * 1e6).astype(np.int64) + 17 * sensor) * 1000)
    np.testing.assert_array_equal(recording.values, np.hstack([values + sensor, 0.001 * values + sensor]))
    np.testing.assert_array_equal(recording.temperature.values, temperature + sensor)


def test_what_is_given_wins_over_the_preset(tmp_path):
    table, time, _, values = px4_table(tmp_path / "t.csv", rows=50)
    words = ["--time", "timestamp", "--linear-acceleration-x", "y", "--acceleration-unit", "g", "--time-unit", "us"]
    assert run("import-csv", table, "-o", tmp_path / "bag", "--preset", "px4-ulog", *words) == 0
    recording = read_recording(tmp_path / "bag")
    np.testing.assert_allclose(recording.values[:, 0], 9.80665 * values[:, 1], rtol=1e-15)
    np.testing.assert_array_equal(recording.stamps, np.rint(time * 1e9).astype(np.int64) + 350_000)
    words = ["--time", "timestamp", "--time-unit", "ms"]
    assert run("import-csv", table, "-o", tmp_path / "slow", "--preset", "px4-ulog", *words) == 0
    assert read_recording(tmp_path / "slow").duration == pytest.approx(1000.0 * recording.duration)


def test_mistakes_are_one_line_and_leave_nothing(tmp_path, capsys):
    px4 = px4_table(tmp_path / "px4.csv", rows=20)[0]
    two = ardupilot_table(tmp_path / "two.csv", (1, 2), rows=20)[0]
    out = tmp_path / "bag"
    assert "no row with 0 in column 'I': it has 1, 2" in refused(
        capsys, "import-csv", two, "-o", out, "--preset", "ardupilot-imu"
    )
    assert "no column 'TimeUS'" in refused(capsys, "import-csv", px4, "-o", out, "--preset", "ardupilot-imu")
    assert "no column 'timestamp_sample'" in refused(capsys, "import-csv", two, "-o", out, "--preset", "px4-ulog")
    assert "--time is missing" in refused(capsys, "import-csv", px4, "-o", out, "--temperature", "temperature")
    assert "--temperature is missing" in refused(capsys, "import-csv", px4, "-o", out, "--time", "timestamp")
    words = ("import-csv", px4, "-o", out, "--preset", "px4-ulog", "--sensor", 1)
    assert "--sensor is for" in refused(capsys, *words)
    assert "px4-ulog" in refused(capsys, "import-csv", px4, "-o", out, "--preset", "list")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["px4.csv", "two.csv"]


def test_help_shows_every_preset_and_what_makes_its_table(capsys):
    assert run("import-csv", "--help") == 0
    shown = capsys.readouterr().out
    for name, preset in PRESETS.items():
        assert f"{name}: {preset.made_by}" in shown


def test_from_a_log_of_px4_to_its_parameters(tmp_path):
    table, _, temperature, _ = px4_table(tmp_path / "log_sensor_accel_0.csv")
    bag, cal, params = tmp_path / "bag", tmp_path / "cal.json", tmp_path / "out.params"
    reference = f"--reference={','.join(str(value) for value in STILL.tolist())}"
    assert run("import-csv", table, "-o", bag, "--preset", "px4-ulog") == 0
    assert run("train", bag, "-o", cal, "--method", "polynomial", reference) == 0
    assert run("export", cal, "--format", "px4", "--device-id", 42, "-o", params) == 0
    values, _ = ground_station(params.read_text())
    for measured in np.linspace(temperature.min(), temperature.max(), 7):
        expected = np.polynomial.polynomial.polyval(measured - 30.0, COEFFICIENTS.T)
        # Noise of 0.002 m/s² over 3000 samples, and four coefficients.
        np.testing.assert_allclose(px4_offset(values, "A", 0, measured), expected, atol=5e-4)
