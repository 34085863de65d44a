import numpy as np
import pytest

from hgma_compensation.errors import RefusedError
from hgma_compensation.recording.csv_table import Columns, read_table
from hgma_compensation.stamps import NANOSECONDS

CHANNELS = {"linear_acceleration.z": "az"}


def write(path, rows, header="t,T,az"):
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


def table(tmp_path, rows, header="t,T,az", **columns):
    file = write(tmp_path / "table.csv", rows, header)
    return read_table(file, Columns(**{"time": "t", "temperature": "T", "channels": CHANNELS, **columns}))


def test_columns_become_si_channels(tmp_path):
    recording = table(
        tmp_path,
        ["0,300,1,2,90", "500,301,1.5,2,180"],
        header="t,T,az,wx,wy",
        channels={"linear_acceleration.z": "az", "angular_velocity.x": "wx", "angular_velocity.y": "5"},
        time_unit="ms",
        temperature_unit="K",
        acceleration_unit="g",
        rate_unit="deg/s",
    )
    # A stamp of 0 says in ROS that there is none.
    assert recording.stamps.tolist() == [NANOSECONDS, NANOSECONDS + NANOSECONDS // 2]
    np.testing.assert_allclose(recording.values[:, 2], [9.80665, 14.709975])
    np.testing.assert_allclose(recording.values[:, 4], [np.pi / 2, np.pi])
    np.testing.assert_allclose(recording.temperature.values, [26.85, 27.85])
    assert recording.present == ("linear_acceleration.z", "angular_velocity.x", "angular_velocity.y")


def test_fahrenheit_is_converted(tmp_path):
    recording = table(tmp_path, ["0,32,1", "1,212,1"], temperature_unit="F")
    np.testing.assert_allclose(recording.temperature.values, [0.0, 100.0], atol=1e-12)


def test_rows_are_cut_on_the_scale_of_the_time_column(tmp_path):
    rows = [f"{t},25,1" for t in range(100, 110)]
    assert table(tmp_path, rows, start=103, end=106).stamps.tolist() == [t * NANOSECONDS for t in (103, 104, 105)]
    assert table(tmp_path, rows, skip_rows=8).stamps.tolist() == [108 * NANOSECONDS, 109 * NANOSECONDS]


def test_auxiliary_columns_are_read(tmp_path):
    recording = table(
        tmp_path,
        ["0,25,1,26,3.3", "1,25,1,27,3.2"],
        header="t,T,az,T2,V",
        temperature_2="T2",
        supply_voltage="V",
    )
    assert recording.temperature_2.values.tolist() == [26.0, 27.0]
    assert recording.supply_voltage.values.tolist() == [3.3, 3.2]


@pytest.mark.parametrize(
    ("rows", "columns", "message"),
    [
        (["0,25,1", "1,25,x"], {}, r"line 3: column 'az' holds no finite number"),
        (["0,25,1", "1,,1"], {}, r"line 3: column 'T' holds no finite number"),
        (["0,25,1", "1,25"], {}, r"line 3: column 'az'"),
        (["0,25,1", "1,25,nan"], {}, r"line 3: column 'az'"),
        (["0,25,1", "0,25,1"], {}, r"time does not increase at data row 2"),
        (["1,25,1", "0,25,1"], {}, r"time does not increase at data row 2"),
        (["0,25,1", "1,25,1"], {"time": "seconds"}, r"no column 'seconds': it has t, T, az"),
        (["0,25,1", "1,25,1"], {"time": "4"}, r"no column '4'"),
        (["0,25,1", "1,25,1"], {"start": 5.0}, r"0 rows between --from and --until: its time runs from 0 s to 1 s"),
        (["0,25,1", "1,25,1"], {"skip_rows": 1}, r"1 data rows after --skip-rows 1"),
        (["0,25,1", "1,25,1"], {"channels": {}}, r"no channel is named"),
    ],
)
def test_what_is_wrong_with_a_table_is_said(tmp_path, rows, columns, message):
    with pytest.raises(RefusedError, match=message):
        table(tmp_path, rows, **columns)


def test_a_file_that_is_no_table_is_refused(tmp_path):
    columns = Columns("t", "T", CHANNELS)
    with pytest.raises(RefusedError, match="cannot be read"):
        read_table(tmp_path / "missing.csv", columns)
    (tmp_path / "empty.csv").write_text("")
    with pytest.raises(RefusedError, match="is empty"):
        read_table(tmp_path / "empty.csv", columns)
    (tmp_path / "binary.csv").write_bytes(bytes(range(256)))
    with pytest.raises(RefusedError, match=r"binary\.csv"):
        read_table(tmp_path / "binary.csv", columns)


def test_progress_tells_of_bytes_up_to_nearly_all_of_them(tmp_path):
    file = write(tmp_path / "t.csv", [f"{row},25,{row}" for row in range(45_000)])
    told = []
    read_table(file, Columns(time="t", temperature="T", channels=CHANNELS), told.append)
    assert all(step >= 0 for step in told)
    assert 0.8 * file.stat().st_size < sum(told) <= file.stat().st_size
