"""Why an input was not used as it came: a name for the diagnostics, and what the operator should do."""

from enum import Enum

from hgma_compensation.temperature.track import Sample


class Skip(Enum):
    """Reasons for which an accelerometer sample has no output; the value is the name in the diagnostics."""

    NO_CALIBRATION = "no_calibration"
    NOT_ACTIVE = "node_not_active"
    NOT_FINITE = "acceleration_not_finite"
    MALFORMED_BLOCK = "block_malformed"


class Note(Enum):
    """What is counted without costing a sample."""

    TEMPERATURE_LATE = "temperature_late"
    TIME_JUMPED_BACK = "acceleration_time_jumped_back"


REMEDIES: dict[str, str] = {
    Skip.NO_CALIBRATION.value: "set the parameter calibration_file, or call ~/load_calibration",
    Skip.NOT_ACTIVE.value: "activate the node (ros2 lifecycle set), or start it with autostart",
    Skip.NOT_FINITE.value: "check the accelerometer's driver: it sends NaN or infinity",
    Skip.MALFORMED_BLOCK.value: "check the driver: x, y, z of a block must have equal length and "
    "sample_interval must be positive",
    Note.TEMPERATURE_LATE.value: "the thermistor's messages arrive later than features.latency of the calibration: "
    "check its driver's stamps and load",
    Note.TIME_JUMPED_BACK.value: "expected when a bag loops; else check the clock that stamps the accelerometer",
    Sample.RESTARTED.value: "expected when a bag loops; else check the clock that stamps the thermistor",
    Sample.REPEATED.value: "check the thermistor's driver: it sends the same stamp again",
    Sample.OUT_OF_ORDER.value: "check the thermistor's driver: its stamps do not increase",
    Sample.NOT_FINITE.value: "check the thermistor: its driver sends NaN or infinity",
    Sample.IMPLAUSIBLE.value: "check the thermistor's wiring and unit: it must send °C between -100 and 250",
}
