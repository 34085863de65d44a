"""Why an input was not used as it came: a name for the diagnostics, and what the operator should do."""

from enum import Enum

from hgma_compensation.effects.effect import Need
from hgma_compensation.pipeline.taking_up import DROPPED
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
    TEMPERATURE_2_LATE = "temperature_2_late"
    SUPPLY_VOLTAGE_LATE = "supply_voltage_late"
    TEMPERATURE_2_MISSING = "temperature_2_missing"
    SUPPLY_VOLTAGE_MISSING = "supply_voltage_missing"
    TIME_JUMPED_BACK = "acceleration_time_jumped_back"


LATE = {
    None: Note.TEMPERATURE_LATE,
    Need.TEMPERATURE_2: Note.TEMPERATURE_2_LATE,
    Need.SUPPLY_VOLTAGE: Note.SUPPLY_VOLTAGE_LATE,
}
MISSING = {Need.TEMPERATURE_2: Note.TEMPERATURE_2_MISSING, Need.SUPPLY_VOLTAGE: Note.SUPPLY_VOLTAGE_MISSING}


def sample_name(need: Need | None, sample: Sample) -> str:
    """Return the name in the diagnostics of what became of a sample of an input, None for the thermistor."""
    return sample.value if need is None else sample.value.replace("temperature", need.value, 1)


_BAD_SAMPLES = {
    Sample.RESTARTED: "expected when a bag loops; else check the clock that stamps the {}",
    Sample.REPEATED: "check the {}'s driver: it sends the same stamp again",
    Sample.OUT_OF_ORDER: "check the {}'s driver: its stamps do not increase",
    Sample.NOT_FINITE: "check the {}: its driver sends NaN or infinity",
    Sample.IMPLAUSIBLE: "check the {}'s wiring and unit: it must send °C between -100 and 250",
}
_INPUTS: dict[Need | None, str] = {
    None: "thermistor",
    Need.TEMPERATURE_2: "second thermometer",
    Need.SUPPLY_VOLTAGE: "supply voltage",
}
_LATE = "the {}'s messages arrive later than features.latency of the calibration: check its driver's stamps and load"
_MISSING = "an effect of the calibration needs the {}, which has never come, and is left out: check the topic accel/{}"

REMEDIES: dict[str, str] = {
    Skip.NO_CALIBRATION.value: "set the parameter calibration_file, or call ~/load_calibration",
    Skip.NOT_ACTIVE.value: "activate the node (ros2 lifecycle set), or start it with autostart",
    Skip.NOT_FINITE.value: "check the accelerometer's driver: it sends NaN or infinity",
    Skip.MALFORMED_BLOCK.value: "check the driver: x, y, z of a block must have equal length and "
    "sample_interval must be positive",
    Note.TIME_JUMPED_BACK.value: "expected when a bag loops; else check the clock that stamps the accelerometer",
    **{past.value: remedy for past, remedy in DROPPED.items()},
    **{note.value: _LATE.format(_INPUTS[need]) for need, note in LATE.items()},
    **{note.value: _MISSING.format(_INPUTS[need], need.value) for need, note in MISSING.items()},
    **{
        sample_name(need, sample): remedy.format(name)
        for need, name in _INPUTS.items()
        for sample, remedy in _BAD_SAMPLES.items()
        if need is not Need.SUPPLY_VOLTAGE or sample is not Sample.IMPLAUSIBLE
    },
}
