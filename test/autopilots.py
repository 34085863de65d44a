"""What PX4 and ArduPilot do with a file of parameters, written after their sources: an oracle in single precision."""

import numpy as np

F = np.float32
AXES = "XYZ"
GROUPS = {"A": "ACC", "G": "GYR"}


def ground_station(text):
    """Return name and value of each line of a file of QGroundControl, and its types.

    PX4/PX4-Autopilot Tools/process_sensor_caldata.py writes it: vehicle, component, name, value, type.
    """
    rows = [line.split("\t") for line in text.splitlines() if not line.startswith("#")]
    assert all(row[:2] == ["1", "1"] and len(row) == 5 for row in rows)
    return {row[2]: row[3] for row in rows}, {row[2]: int(row[4]) for row in rows}


def shell(text):
    """Return name and value of each ``param set``."""
    rows = [line.split() for line in text.splitlines() if not line.startswith("#")]
    assert rows.pop() == ["param", "save"]
    assert all(row[:2] == ["param", "set"] and len(row) == 4 for row in rows)
    return {row[2]: row[3] for row in rows}


def commas(text):
    """Return name and value of each line of a file of ArduPilot's ground stations."""
    rows = [line.split(",") for line in text.splitlines() if not line.startswith("#")]
    assert all(len(row) == 2 for row in rows)
    return dict(rows)


def px4_offset(values, letter, instance, temperature):
    """Return the three offsets at a temperature.

    PX4/PX4-Autopilot src/modules/temperature_compensation/TemperatureCompensation.cpp, calc_thermal_offsets_3D.
    """
    prefix = f"TC_{letter}{instance}_"
    value = {name: F(text) for name, text in values.items()}
    measured = F(temperature)
    lowest, highest, reference = (value[prefix + name] for name in ("TMIN", "TMAX", "TREF"))
    if measured > highest:
        delta = highest - reference
    elif measured < lowest:
        delta = lowest - reference
    else:
        delta = measured - reference
    delta_2 = delta * delta
    delta_3 = delta_2 * delta
    return [
        value[f"{prefix}X0_{i}"]
        + value[f"{prefix}X1_{i}"] * delta
        + value[f"{prefix}X2_{i}"] * delta_2
        + value[f"{prefix}X3_{i}"] * delta_3
        for i in range(3)
    ]


def ardupilot_correction(values, group, instance, temperature, calibrated_at):
    """Return what is added to the three axes at a temperature.

    ArduPilot/ardupilot libraries/AP_InertialSensor/AP_InertialSensor_tempcal.cpp, correct_sensor and polynomial_eval.
    """
    prefix = f"INS_TCAL{instance + 1}_"
    value = {name: F(text) for name, text in values.items()}
    lowest, highest = value[prefix + "TMIN"], value[prefix + "TMAX"]

    def constrained(measured):
        return min(max(F(measured), lowest), highest)

    def evaluated(axis, delta):
        c = [value[f"{prefix}{group}{power}_{axis}"] for power in (1, 2, 3)]
        return (c[0] + (c[1] + c[2] * delta) * delta) * delta * F(1.0e-6)

    now, then = (constrained(t) - F(35.0) for t in (temperature, calibrated_at))
    return [F(0.0) - evaluated(axis, now) + evaluated(axis, then) for axis in AXES]
