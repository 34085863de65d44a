"""Parameters of PX4's temperature compensation, and what PX4 makes of them.

Sources, all in PX4/PX4-Autopilot:
names, types and defaults: src/modules/temperature_compensation/module.yaml;
polynomial, clipping, sensor's identity: .../TemperatureCompensation.cpp (calc_thermal_offsets_3D, set_sensor_id);
corrected = raw - offset, m/s² and rad/s: .../TemperatureCompensation.h; before offsets, scale factors and rotation:
src/lib/sensor_calibration/Accelerometer.hpp (Correct);
once a second, and published after a change by 1 °C: .../TemperatureCompensationModule.cpp (Run, accelPoll);
reference temperature in the middle, file of parameters: Tools/process_sensor_caldata.py.
"""

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import AXES
from hgma_compensation.drift.inputs import Array
from hgma_compensation.migration.cubic import Cubic, Span
from hgma_compensation.migration.parameters import Parameter, coefficient, groups_of
from hgma_compensation.stamps import NANOSECONDS, Stamps

LETTERS = {"linear_acceleration": "A", "angular_velocity": "G"}
ID_OPTIONS = {"linear_acceleration": "--device-id", "angular_velocity": "--gyro-device-id"}
"""Options of ``hgma export`` that give a sensor's identity."""

INSTANCES = 4
REFERENCE = None
"""The reference temperature is a parameter: the middle of the range, as PX4's own script has it."""

INT32, REAL32 = 6, 9
"""MAV_PARAM_TYPE, the last column of a file of QGroundControl."""

LARGEST_ID = 2**32 - 1
POLL = NANOSECONDS
RENEWED_AFTER = np.float32(1.0)
"""°C by which the temperature must have changed for new offsets to be published."""

Single = NDArray[np.float32]


def parameters(
    cubics: Mapping[str, Cubic], span: Span, instance: int, device_ids: Mapping[str, int]
) -> list[Parameter]:
    """Return the parameters of the sensor ``instance``; cubics: by channel, about the span's reference.

    device_ids: by Imu field, of 32 bits; an id that is missing is left as the vehicle has it.
    """
    found = []
    for group in groups_of(cubics):
        letter = LETTERS[group]
        prefix = f"TC_{letter}{instance}_"
        found.append(Parameter(f"TC_{letter}_ENABLE", 1))
        if group in device_ids:
            # The parameter is a signed number, which PX4 compares as an unsigned one.
            found.append(Parameter(f"{prefix}ID", int(np.uint32(device_ids[group]).view(np.int32))))
        limits = (("TREF", span.reference), ("TMIN", span.lowest), ("TMAX", span.highest))
        found += [Parameter(prefix + name, value) for name, value in limits]
        found += [
            Parameter(f"{prefix}X{power}_{number}", coefficient(cubics, group, axis, power))
            for number, axis in enumerate(AXES)
            for power in range(4)
        ]
    return found


def ground_station_file(found: Sequence[Parameter], comments: Sequence[str]) -> str:
    """Return the file that QGroundControl loads: vehicle, component, name, value, type, with tabs between."""
    lines = [f"# {comment}" for comment in comments] + ["# Vehicle-Id Component-Id Name Value Type"]
    for parameter in found:
        kind = INT32 if isinstance(parameter.value, int) else REAL32
        lines.append(f"1\t1\t{parameter.name}\t{parameter.text}\t{kind}")
    return "\n".join(lines) + "\n"


def shell_script(found: Sequence[Parameter], comments: Sequence[str]) -> str:
    """Return commands for the NuttX shell, or a start-up script on the card."""
    lines = [f"# {comment}" for comment in comments]
    return "\n".join([*lines, *(f"param set {p.name} {p.text}" for p in found), "param save"]) + "\n"


def offset(cubic: Cubic, span: Span, temperature: Array) -> Single:
    """Return the offset (n,) that PX4 computes in single precision for temperatures (n,) °C."""
    limits = [np.float32(value) for value in (span.lowest, span.highest, span.reference)]
    clipped = np.minimum(np.maximum(temperature.astype(np.float32), limits[0]), limits[1])
    delta = clipped - limits[2]
    x0, x1, x2, x3 = cubic.coefficients.astype(np.float32)
    square = delta * delta
    return np.asarray(x0 + x1 * delta + x2 * square + x3 * (square * delta), dtype=np.float32)


class Held:
    """The temperature that PX4's offsets are for: looked at once a second, renewed after a change by 1 °C."""

    def __init__(self) -> None:
        """Start before the first sample."""
        self._polled = -POLL
        self._last = np.float32(-100.0)
        self._used = 0.0

    def used(self, stamps: Stamps, temperature: Array) -> Array:
        """Return the temperatures (n,) °C whose offsets are in use; stamps (n,) in ns, after those before."""
        result = np.empty(len(stamps))
        steps_back = np.flatnonzero(np.diff(stamps) < 0) + 1
        for start, stop in pairwise([0, *steps_back.tolist(), len(stamps)]):
            row = start
            while row < stop:
                stamp = int(stamps[row])
                if not self._polled <= stamp < self._polled + POLL:
                    self._poll(stamp, float(temperature[row]))
                end = row + int(np.searchsorted(stamps[row:stop], self._polled + POLL))
                result[row:end] = self._used
                row = end
        return result

    def _poll(self, stamp: int, temperature: float) -> None:
        self._polled = stamp
        if abs(np.float32(temperature) - self._last) > RENEWED_AFTER:
            self._last, self._used = np.float32(temperature), temperature
