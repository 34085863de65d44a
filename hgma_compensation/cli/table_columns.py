"""Which columns of a table are what, guessed by their names, as the options of ``hgma import-csv``."""

import re
from collections.abc import Sequence

from hgma_compensation.channels import CHANNELS

_TIME = re.compile(r"(t|time|times|timestamp|stamp|sec|secs|second|seconds|timeus|timems)")
_TEMPERATURE = re.compile(r"(temp|temperature|thermistor|imutemp|sensortemp|ntc|thermistortemp|temp1|temperature1|t1)")
_TEMPERATURE_2 = re.compile(r"(temp2|temperature2|t2|ambient|ambienttemp|casetemp|boardtemp|ambienttemperature)")
_VOLTAGE = re.compile(r"(v|vdd|vcc|vin|voltage|supply|supplyvoltage)")
_ACCELERATION = "(?:a|acc|accel|acceleration|linacc|linearacceleration|accelerometer|imuacc|imuaccel)"
_RATE = "(?:g|w|gyr|gyro|omega|rate|angvel|angularvelocity|gyroscope|imugyr|imugyro)"
_UNITS = {
    "s": ("time", "s"), "sec": ("time", "s"), "ms": ("time", "ms"), "us": ("time", "us"), "µs": ("time", "us"),
    "ns": ("time", "ns"), "g": ("acceleration", "g"), "mg": ("acceleration", "mg"), "kg": ("acceleration", "kg"),
    "dps": ("angular-velocity", "deg/s"), "degps": ("angular-velocity", "deg/s"), "degs": ("angular-velocity", "deg/s"),
    "k": ("temperature", "K"), "kelvin": ("temperature", "K"), "f": ("temperature", "F"), "degf": ("temperature", "F"),
    "°f": ("temperature", "F"), "c": ("temperature", "C"), "degc": ("temperature", "C"), "°c": ("temperature", "C"),
    "ms2": ("acceleration", "m/s^2"), "mps2": ("acceleration", "m/s^2"), "rads": ("angular-velocity", "rad/s"),
    "radps": ("angular-velocity", "rad/s"), "v": ("voltage", "V"),
}  # fmt: skip
"""The ending of a column's name, letters and digits only: what it measures and the unit as import-csv has it."""

_DEFAULTS = {"time": "s", "acceleration": "m/s^2", "angular-velocity": "rad/s", "temperature": "C", "voltage": "V"}
_EPOCHS = ((1e17, "ns"), (1e14, "us"), (1e11, "ms"))
"""A time above this, without a unit in its name, is one of our day since 1970 in that unit."""


def import_options(columns: Sequence[str], first_row: Sequence[str] = ()) -> tuple[list[str], list[str]]:
    """Return the options of import-csv for a table with these columns, and those that were not found.

    first_row: the fields of its first data row, which tell a time in s from one in ns. What is not found among time,
    temperature and at least one channel stands in the options as COL.
    """
    taken: dict[str, tuple[str, str | None]] = {}
    for column in columns:
        base, known = _base_and_unit(column)
        option = _option(base, known[0] if known else None)
        if option is not None and option not in taken:
            taken[option] = (column, known[1] if known else None)
    if "time" in taken and taken["time"][1] is None:
        taken["time"] = (taken["time"][0], _epoch(columns, first_row, taken["time"][0]))
    missing = [name for name in ("time", "temperature") if name not in taken]
    channels = [_flag(channel) for channel in CHANNELS]
    if not any(name in taken for name in channels):
        missing.append("linear-acceleration-z")
    order = ("time", "temperature", *channels, "temperature-2", "supply-voltage")
    words: list[str] = []
    for name in order:
        if name in taken or name in missing:
            words += [f"--{name}", taken[name][0] if name in taken else "COL"]
    units = {_measured(name): found for name, (_, found) in taken.items() if found is not None}
    for measured, unit in units.items():
        if unit != _DEFAULTS[measured] and measured != "voltage":
            words += [f"--{measured}-unit", unit]
    return words, missing


def _flag(channel: str) -> str:
    return channel.replace("_", "-").replace(".", "-")


def _plain(text: str) -> str:
    if text.strip() == "T":  # beside a column t
        return "temperature"
    return re.sub(r"[^a-z0-9µ°]", "", text.lower())


def _base_and_unit(column: str) -> tuple[str, tuple[str, str] | None]:
    """Return a column's name without its unit, letters and digits only, and the unit, of "az [g]" or "temp_degC"."""
    bracketed = re.fullmatch(r"\s*(.*?)\s*[\[(]([^\])]*)[\])]\s*", column)
    if bracketed:
        return _plain(bracketed.group(1)), _UNITS.get(_plain(bracketed.group(2)))
    first, separator, last = column.strip().rpartition("_")
    unit = _UNITS.get(_plain(last)) if separator else None
    if unit is not None and _option(_plain(first), unit[0]) is not None:
        return _plain(first), unit
    if column in ("TimeUS", "TimeMS"):
        return "time", ("time", column[4:].lower())
    return _plain(column), None


def _option(base: str, measured: str | None) -> str | None:
    """Return the option of a column by its name, None where it is none or contradicts its unit."""
    option = _by_name(base)
    return option if option is None or measured is None or _measured(option) == measured else None


def _by_name(base: str) -> str | None:
    for group, words in (("linear-acceleration", _ACCELERATION), ("angular-velocity", _RATE)):
        axis = re.fullmatch(f"{words}([xyz])", base)
        if axis:
            return f"{group}-{axis.group(1)}"
    if base in ("x", "y", "z"):
        return f"linear-acceleration-{base}"
    for pattern, option in (
        (_TEMPERATURE_2, "temperature-2"),
        (_TEMPERATURE, "temperature"),
        (_TIME, "time"),
        (_VOLTAGE, "supply-voltage"),
    ):
        if pattern.fullmatch(base):
            return option
    return None


def _measured(option: str) -> str:
    if option.startswith("temperature"):
        return "temperature"
    if option == "supply-voltage":
        return "voltage"
    for group, measured in (("linear-acceleration", "acceleration"), ("angular-velocity", "angular-velocity")):
        if option.startswith(group):
            return measured
    return option


def _epoch(columns: Sequence[str], row: Sequence[str], column: str) -> str | None:
    try:
        value = float(row[list(columns).index(column)])
    except (ValueError, IndexError):
        return None
    return next((unit for above, unit in _EPOCHS if value > above), None)
