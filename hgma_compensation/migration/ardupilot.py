"""Parameters of ArduPilot's IMU temperature calibration, and what ArduPilot makes of them.

Sources, all in ArduPilot/ardupilot:
names, scale, reference temperature, polynomial, clamping: libraries/AP_InertialSensor/AP_InertialSensor_tempcal.cpp
(SCALE_FACTOR, TEMP_REFERENCE, polynomial_eval, correct_sensor); INS_TCAL1 to 3, INS_ACC1_CALTEMP, the range of
INS_ACCOFFS: libraries/AP_InertialSensor/AP_InertialSensor.cpp; after the rotation of the sensor, before offsets, scale
factors and the rotation of the board: libraries/AP_InertialSensor/AP_InertialSensor_Backend.cpp
(_rotate_and_correct_accel); file of parameters: Tools/Frame_params/Sub/bluerov2-heavy-3_5_4.params.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import AXES
from hgma_compensation.drift.inputs import Array
from hgma_compensation.migration.cubic import Cubic, Span
from hgma_compensation.migration.parameters import Parameter, coefficient, groups_of

NAMES = {"linear_acceleration": "ACC", "angular_velocity": "GYR"}
INSTANCES = 3
REFERENCE = 35.0
"""°C, fixed in the firmware."""

SCALE = 1e6
"""Parameters over coefficients."""

TEMPERATURES = (-70.0, 80.0)
"""°C: the documented range of TMIN and TMAX."""

SMALLEST_SPAN = 10.0
"""°C that TMAX must lie above TMIN, as its description says."""

LARGEST_OFFSET = 3.5
"""m/s²: the documented range of INS_ACCOFFS, which must hold what is left at the temperature of the calibration."""


def parameters(cubics: Mapping[str, Cubic], span: Span, instance: int) -> list[Parameter]:
    """Return the parameters of the IMU ``instance``, counted from 0; cubics: by channel, about 35 °C.

    The constant term is not among them: ArduPilot takes the difference to the temperature at which its accelerometer
    was calibrated (INS_ACCn_CALTEMP), and that calibration holds the rest.
    """
    prefix = f"INS_TCAL{instance + 1}_"
    found = [
        Parameter(f"{prefix}ENABLE", 1),
        Parameter(f"{prefix}TMIN", span.lowest),
        Parameter(f"{prefix}TMAX", span.highest),
    ]
    for group in groups_of(cubics):
        found += [
            Parameter(f"{prefix}{NAMES[group]}{power}_{axis.upper()}", SCALE * coefficient(cubics, group, axis, power))
            for power in (1, 2, 3)
            for axis in AXES
        ]
    return found


def parameter_file(found: Sequence[Parameter], comments: Sequence[str]) -> str:
    """Return the file that ground stations load: a name and a value on each line, with a comma between."""
    lines = [f"# {comment}" for comment in comments]
    return "\n".join([*lines, *(f"{p.name},{p.text}" for p in found)]) + "\n"


def polynomial(cubic: Cubic, span: Span, temperature: Array) -> NDArray[np.float32]:
    """Return the polynomial (n,) that ArduPilot computes in single precision for temperatures (n,) °C.

    The correction is its difference to the same at the temperature of the accelerometer's calibration.
    """
    lowest, highest = np.float32(span.lowest), np.float32(span.highest)
    delta = np.minimum(np.maximum(temperature.astype(np.float32), lowest), highest) - np.float32(REFERENCE)
    c1, c2, c3 = (SCALE * cubic.coefficients[1:]).astype(np.float32)
    return np.asarray((c1 + (c2 + c3 * delta) * delta) * delta * np.float32(1.0 / SCALE), dtype=np.float32)
