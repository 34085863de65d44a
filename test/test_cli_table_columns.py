import pytest
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.cli.table_columns import import_options

NONE = ()


@pytest.mark.parametrize(
    ("header", "row", "options"),
    [
        ("t,T,az", NONE, "--time t --temperature T --linear-acceleration-z az"),
        ("time_s,temp_degC,acc_x,acc_y", NONE,
         "--time time_s --temperature temp_degC --linear-acceleration-x acc_x --linear-acceleration-y acc_y"),
        ("TimeUS,GyrX,AccX,T", NONE,
         "--time TimeUS --temperature T --linear-acceleration-x AccX --angular-velocity-x GyrX --time-unit us"),
        ("Time [ms],Temperature (F),Accel Z [mg],Gyro Z [deg/s]", NONE,
         "--time Time [ms]|--temperature|Temperature (F)|--linear-acceleration-z|Accel Z [mg]|"
         "--angular-velocity-z|Gyro Z [deg/s]|--time-unit|ms|--temperature-unit|F|--acceleration-unit|mg|"
         "--angular-velocity-unit|deg/s"),
        ("timestamp,temperature,z", ("1600000000000000000", "20", "9.8"),
         "--time timestamp --temperature temperature --linear-acceleration-z z --time-unit ns"),
        ("timestamp,temperature,z", ("12.5", "20", "9.8"),
         "--time timestamp --temperature temperature --linear-acceleration-z z"),
        ("t,temp,temp2,vdd,az_g", NONE,
         "--time t --temperature temp --linear-acceleration-z az_g --temperature-2 temp2 --supply-voltage vdd "
         "--acceleration-unit g"),
        ("linear_acceleration.x,sec,thermistor", NONE,
         "--time sec --temperature thermistor --linear-acceleration-x linear_acceleration.x"),
    ],
)  # fmt: skip
def test_columns_are_told_by_their_names(header, row, options):
    found, missing = import_options(header.split(","), row)
    wanted = options.replace("--time Time [ms]", "--time|Time [ms]").split("|" if "|" in options else " ")
    assert (found, missing) == (wanted, [])


def test_what_is_not_found_is_left_to_the_user():
    options, missing = import_options(("a", "b", "height"))
    assert options == ["--time", "COL", "--temperature", "COL", "--linear-acceleration-z", "COL"]
    assert missing == ["time", "temperature", "linear-acceleration-z"]


def test_a_unit_that_belongs_to_something_else_is_no_unit():
    options, _ = import_options(("t", "temp", "acc_z", "gyro_g"))
    assert "--acceleration-unit" not in options


@given(st.lists(st.text(max_size=20), max_size=8), st.lists(st.text(max_size=20), max_size=8))
def test_any_header_is_survived(columns, row):
    options, missing = import_options(columns, row)
    assert len(options) % 2 == 0
    assert {"--time", "--temperature"} <= set(options)
    assert all(
        value == "COL" or value in columns or flag.endswith("-unit")
        for flag, value in zip(options[::2], options[1::2], strict=True)
    )
    assert len([v for v in options[1::2] if v == "COL"]) >= len(missing)
