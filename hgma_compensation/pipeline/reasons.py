"""Why an input was not used as it came: a name for the diagnostics, and what the operator should do."""

from enum import Enum

from hgma_compensation.effects.effect import Need
from hgma_compensation.pipeline.status import TemperatureStatus
from hgma_compensation.pipeline.stretches import Cut
from hgma_compensation.pipeline.taking_up import DROPPED
from hgma_compensation.pipeline.transport import TRANSPORT_REMEDIES
from hgma_compensation.temperature.track import Sample


class Skip(Enum):
    """Reasons for which an accelerometer sample has no output; the value is the name in the diagnostics."""

    NO_CALIBRATION = "no_calibration"
    NOT_ACTIVE = "node_not_active"
    NOT_STAMPED = "acceleration_not_stamped"
    NOT_FINITE = "acceleration_not_finite"
    IMPLAUSIBLE = "acceleration_implausible"
    ABSENT = "acceleration_absent"
    OTHER_FRAME = "acceleration_of_another_frame"
    UNREADABLE = "acceleration_unreadable"
    MALFORMED_BLOCK = "block_malformed"
    STOPPED = "output_stopped"


class Note(Enum):
    """What is counted without costing a sample."""

    STAMP_REPEATED = "acceleration_stamp_repeated"
    OUT_OF_ORDER = "acceleration_out_of_order"
    FRAME_CHANGED = "acceleration_frame_changed"
    COVARIANCE_INVALID = "acceleration_covariance_invalid"
    TEMPERATURE_AHEAD = "temperature_ahead"
    TEMPERATURE_LATE = "temperature_late"
    TEMPERATURE_2_LATE = "temperature_2_late"
    SUPPLY_VOLTAGE_LATE = "supply_voltage_late"
    TEMPERATURE_2_MISSING = "temperature_2_missing"
    SUPPLY_VOLTAGE_MISSING = "supply_voltage_missing"
    TEMPERATURE_2_STALE = "temperature_2_stale"
    SUPPLY_VOLTAGE_STALE = "supply_voltage_stale"


LATE = {
    None: Note.TEMPERATURE_LATE,
    Need.TEMPERATURE_2: Note.TEMPERATURE_2_LATE,
    Need.SUPPLY_VOLTAGE: Note.SUPPLY_VOLTAGE_LATE,
}
MISSING = {Need.TEMPERATURE_2: Note.TEMPERATURE_2_MISSING, Need.SUPPLY_VOLTAGE: Note.SUPPLY_VOLTAGE_MISSING}
STALE = {Need.TEMPERATURE_2: Note.TEMPERATURE_2_STALE, Need.SUPPLY_VOLTAGE: Note.SUPPLY_VOLTAGE_STALE}


def sample_name(need: Need | None, sample: Sample) -> str:
    """Return the name in the diagnostics of what became of a sample of an input, None for the thermistor."""
    return sample.value if need is None else sample.value.replace("temperature", need.value, 1)


def status_name(status: TemperatureStatus) -> str:
    """Return the name in the diagnostics of samples that were compensated with a temperature in this status."""
    return f"temperature_status_{status.name.lower()}"


_CLOCKS = {
    Cut.ANEW: "expected when a bag loops or a simulation restarts; else check the clock that stamps the accelerometer",
    Cut.PAUSE: "expected after a time without power; else check the accelerometer's driver and clock",
    Cut.SET_BACK: "a clock was corrected, nothing is lost; keep the clock in step (chrony) if it happens often",
    Cut.RECALLED: "the stamps had jumped ahead and came back, filters went on from before: "
    "check the clock that stamps the accelerometer",
}
_BAD_SAMPLES = {
    Sample.RESTARTED: "expected when a bag loops or a simulation restarts; else check the clock that stamps the {}",
    Sample.SET_BACK: "the clock that stamps the {} was corrected, its history was kept; "
    "keep the clock in step (chrony) if it happens often",
    Sample.RECALLED: "stamps of the {} had jumped ahead and came back, the samples between were dropped: "
    "check the clock that stamps it",
    Sample.MOVED: "the {} jumped and stayed there, its new value is used now: check its wiring",
    Sample.STUCK: "the {} has lost its noise and repeats one value: check its wiring and driver",
    Sample.NOT_STAMPED: "set header.stamp in the driver of the {}: it is zero or negative",
    Sample.REPEATED: "check the {}'s driver: it sends the same stamp again",
    Sample.OUT_OF_ORDER: "check the {}'s driver: its stamps do not increase",
    Sample.NOT_FINITE: "check the {}: its driver sends NaN or infinity",
    Sample.IMPLAUSIBLE: "check the {}'s wiring and unit: it must send {}",
    Sample.JUMPED: "the {} jumps faster than any sensor warms up, such samples are not used: check its wiring",
}
_NOT_OF_VOLTAGE = (Sample.MOVED, Sample.STUCK, Sample.JUMPED)
_CELSIUS = "°C between -100 and 250"
_INPUTS: dict[Need | None, tuple[str, str]] = {
    None: ("thermistor", _CELSIUS),
    Need.TEMPERATURE_2: ("second thermometer", _CELSIUS),
    Need.SUPPLY_VOLTAGE: ("supply voltage", "volts between 0 and 100"),
}
_LATE = "the {}'s messages arrive later than features.latency of the calibration: check its driver's stamps and load"
_MISSING = "an effect of the calibration needs the {}, which has never come, and is left out: check the topic accel/{}"
_STALE = "the {} has been silent for more than a minute, its last value is held: check its driver"

REMEDIES: dict[str, str] = {
    **TRANSPORT_REMEDIES,
    Skip.NO_CALIBRATION.value: "set the parameter calibration_file, or call ~/load_calibration",
    Skip.NOT_ACTIVE.value: "activate the node (ros2 lifecycle set), or start it with autostart",
    Skip.NOT_STAMPED.value: "set header.stamp in the accelerometer's driver: it is zero or negative",
    Skip.NOT_FINITE.value: "check the accelerometer's driver: it sends NaN or infinity",
    Skip.IMPLAUSIBLE.value: "check the accelerometer's driver: it sends more than 1e6 m/s² or rad/s",
    Skip.ABSENT.value: "the driver declares the field absent (-1 in element 0 of its covariance, REP-145): "
    "use a calibration without that channel, or set 0 for an unknown covariance",
    Skip.OTHER_FRAME.value: "another sensor publishes on the topic: remap one of them, or set the parameter frame_id",
    Skip.UNREADABLE.value: "what is published on accel/raw or accel/raw_block is damaged or of another type: "
    "check the accelerometer's driver",
    Skip.MALFORMED_BLOCK.value: "check the driver: x, y, z of a block must have equal length and "
    "sample_interval must be positive",
    Skip.STOPPED.value: "the temperature is not usable and the parameter on_bad_temperature is stop: "
    "mend the thermistor, or set it to continue",
    Note.STAMP_REPEATED.value: "check the accelerometer's driver: it sends the same stamp again",
    Note.OUT_OF_ORDER.value: "check the accelerometer's driver: its stamps do not increase",
    Note.FRAME_CHANGED.value: "header.frame_id has changed, filters began anew: "
    "check that one sensor only publishes on the topic",
    Note.COVARIANCE_INVALID.value: "the driver's covariance is not finite or negative and was replaced by unknown: "
    "send 0 for unknown, -1 in element 0 for absent (REP-145)",
    Note.TEMPERATURE_AHEAD.value: "the thermistor's stamps are more than a minute ahead of the accelerometer's: "
    "use one clock for both",
    **{past.value: remedy for past, remedy in DROPPED.items()},
    **{cut.value: remedy for cut, remedy in _CLOCKS.items()},
    **{note.value: _LATE.format(_INPUTS[need][0]) for need, note in LATE.items()},
    **{note.value: _MISSING.format(_INPUTS[need][0], need.value) for need, note in MISSING.items()},
    **{note.value: _STALE.format(_INPUTS[need][0]) for need, note in STALE.items()},
    **{
        sample_name(need, sample): remedy.format(*names)
        for need, names in _INPUTS.items()
        for sample, remedy in _BAD_SAMPLES.items()
        if need is not Need.SUPPLY_VOLTAGE or sample not in _NOT_OF_VOLTAGE
    },
    status_name(TemperatureStatus.SETTLING): "the temperature's history is short yet, the drift is approximate",
    status_name(TemperatureStatus.STALE): "the thermistor is silent or stamped in the past, its last trend is held: "
    "check its driver and clock",
    status_name(TemperatureStatus.MISSING): "no thermistor sample yet, the drift at mid-range is subtracted: "
    "check the topic accel/temperature",
    status_name(TemperatureStatus.OUT_OF_RANGE): "temperature outside the calibrated range, drift held at its edge: "
    "calibrate over a wider range",
    status_name(TemperatureStatus.INVALID): "the thermistor's last samples are unusable, the trend before is held: "
    "see the reasons that begin with temperature_",
}
