"""Tables that autopilots' logs are exported to: which column holds what, in which unit."""

from collections.abc import Mapping
from dataclasses import dataclass

from hgma_compensation.channels import AXES


@dataclass(frozen=True)
class Preset:
    """One kind of table, with a header line.

    made_by: the command that makes it. source: repository and path that define its columns. channels: column of each
    channel. sensor: column with the number of the sensor, None where each has a table of its own. Units are names of
    ``recording.csv_table``.
    """

    made_by: str
    source: str
    time: str
    time_unit: str
    temperature: str
    channels: Mapping[str, str]
    sensor: str | None = None
    temperature_unit: str = "C"
    acceleration_unit: str = "m/s^2"
    rate_unit: str = "rad/s"


def _columns(group: str, prefix: str, axes: tuple[str, ...] = AXES) -> dict[str, str]:
    return {f"{group}.{axis}": prefix + column for axis, column in zip(AXES, axes, strict=True)}


PRESETS = {
    "px4-ulog": Preset(
        made_by="ulog2csv -m sensor_accel LOG.ulg, file LOG_sensor_accel_0.csv",
        source="PX4/PX4-Autopilot msg/SensorAccel.msg; PX4/pyulog pyulog/ulog2csv.py",
        time="timestamp_sample",
        time_unit="us",
        temperature="temperature",
        channels=_columns("linear_acceleration", ""),
    ),
    "px4-ulog-gyro": Preset(
        made_by="ulog2csv -m sensor_gyro LOG.ulg, file LOG_sensor_gyro_0.csv",
        source="PX4/PX4-Autopilot msg/SensorGyro.msg; PX4/pyulog pyulog/ulog2csv.py",
        time="timestamp_sample",
        time_unit="us",
        temperature="temperature",
        channels=_columns("angular_velocity", ""),
    ),
    "ardupilot-imu": Preset(
        made_by="mavlogdump.py --format csv --types IMU --condition IMU.I==0 LOG.bin",
        source="ArduPilot/ardupilot libraries/AP_InertialSensor/LogStructure.h; "
        "ArduPilot/pymavlink tools/mavlogdump.py",
        time="TimeUS",
        time_unit="us",
        temperature="T",
        channels=_columns("linear_acceleration", "Acc", ("X", "Y", "Z"))
        | _columns("angular_velocity", "Gyr", ("X", "Y", "Z")),
        sensor="I",
    ),
}
"""By the name that ``hgma import-csv --preset`` takes."""
