"""A programme as a scenario of ``hgma simulate``, to be tried on a simulated sensor before the oven is booked."""

from collections.abc import Sequence
from typing import Any

import yaml

from hgma_compensation.effects.registry import kinds
from hgma_compensation.errors import RefusedError
from hgma_compensation.programme import rules
from hgma_compensation.programme.activities import Happening
from hgma_compensation.programme.programme import Programme
from hgma_compensation.programme.rules import Activity

Document = dict[str, Any]

SENSOR: Document = {
    "true_value": 9.80665,
    "drift_span_g": 5367.0,
    "rate_drift": 200.0,
    "white_noise_g_per_h": 17130.0,
    "bias_instability_g_per_h": 4720.0,
}
"""The sensor of params/oven_test.yaml: raw figures of Zhu et al. 2019."""

STILL = {"drift_span_g": 500.0, "white_noise_g_per_h": 17130.0}
"""The axis beside it, where another one is needed."""

VOLTS, VOLTAGE_SHARE = 5.0, 0.02
HEAT = 5.0
LARGEST_G, LATERAL_G, PEAK_G, RMS_G = 1800.0, 1500.0, 3000.0, 250.0
"""g of held levels, of levels of another axis, of shocks and of vibration: what the sensor is made for."""

BAND = [1.5, 2.4]
"""Hz, below half of rules.ACCELEROMETER_RATE."""

EXAMPLES: dict[str, Document] = {
    "thermal_lag": {"time_constant": 120.0},
    "timing_offset": {"delay": 50.0},
    "hysteresis": {"width": 1500.0, "threshold": 4.0},
    "rate_dependent_hysteresis": {"amplitude": 1000.0, "exponent": 0.4},
    "stress_relaxation": {"gain": 30.0, "time_constant": 3600.0, "decades": 0.3},
    "warm_up": {"amplitude": 800.0, "time_constant": 600.0},
    "aging": {"rate": 60.0},
    "thermal_gradient": {"gain": 100.0},
    "supply_voltage": {"gain": 4000.0},
    "scale_factor_temperature": {"linear": 0.05},
    "quadratic_nonlinearity": {"fraction": 0.03, "level": 14700.0},
    "cross_axis": {"source": "y", "gain": 0.02},
    "vibration_rectification": {"coefficient": 1e-4, "time_constant": 5.0},
    "post_shock_zero_shift": {"permanent": 0.008, "transient": 0.02, "time_constant": 900.0},
    "threshold_step": {"temperature": 40.0, "height": 400.0},
    "periodic_interference": {"amplitude": 80.0, "period": 300.0},
}
"""Parameters of the simulated effects: of a size that matters to the sensor above, none that nobody could miss."""

MEMORIES = {"thermal_lag", "stress_relaxation", "warm_up"}
"""Effects whose time constant the user may know."""


def scenario_document(programme: Programme, simulated: Sequence[str], seed: int) -> Document:
    """Return the scenario of a programme, whose sensor has the effects named; they are declared in the bag.

    Raises RefusedError for an effect that the programme is not for, or that the simulator does not know.
    """
    for name in simulated:
        if name not in programme.effects or name not in EXAMPLES:
            known = ", ".join(other for other in programme.effects if other in EXAMPLES) or "none"
            raise RefusedError(f"--simulated {name}: the programme is not for it, or there is no such: it has {known}")
    first, done = programme.steps[0], programme.activities
    document: Document = {
        "scenario": 1,
        "seed": seed,
        "sensor_id": "hgma_link",
        "ground_truth": True,
        "oven": {
            "start": first.start,
            "chamber_time_constant": 60.0,
            "time_constant": 120.0,
            "program": [{"to": step.to, "rate": step.rate, "soak": step.soak} for step in programme.steps],
        },
        "thermistor": {"rate": 2.0 * rules.THERMISTOR_RATE, "noise": 0.02},
        "accelerometer": {"rate": rules.ACCELEROMETER_RATE, "axes": _axes(done)},
    }
    if Activity.HEATING in done:
        document["second_thermometer"] = {"rate": 1.0, "noise": 0.02, "heating": _heating(programme)}
    if Activity.SUPPLY in done:
        document["supply_voltage"] = {"rate": 1.0, "nominal": VOLTS, "noise": 0.0005, "steps": _voltage(programme)}
    if Activity.POWER in done:
        document["power"] = _power(programme)
    document |= {"motion": motion} if (motion := _motion(programme)) else {}
    document |= {"effects": [_effect(programme, name) for name in simulated]} if simulated else {}
    return document


def scenario_text(programme: Programme, simulated: Sequence[str], seed: int) -> str:
    """Return the scenario as YAML, with what it is in a comment."""
    what = f"simulated with {', '.join(simulated)}" if simulated else "simulated without an effect"
    head = (
        f"# Programme of hgma plan for {', '.join(programme.effects)}: {programme.duration / 60.0:.1f} h, {what}.\n"
        f"# Hold-out from {60.0 * programme.hold_out:.0f} s on.\n"
    )
    document = scenario_document(programme, simulated, seed)
    return head + yaml.safe_dump(document, sort_keys=False, default_flow_style=None, width=110)


def _axes(done: Sequence[Activity]) -> Document:
    return {"y": dict(STILL), "z": dict(SENSOR)} if Activity.LATERAL in done else {"z": dict(SENSOR)}


def _of(programme: Programme, activity: Activity) -> list[Happening]:
    return [one for one in programme.happenings if one.activity is activity]


def _lasting(one: Happening) -> Document:
    return {"start": _s(one.time), "end": _s(one.time + one.duration)}


def _heating(programme: Programme) -> list[Document]:
    return [{"rise": HEAT * one.size, **_lasting(one)} for one in _of(programme, Activity.HEATING)]


def _voltage(programme: Programme) -> list[Document]:
    levels = [(one.time, VOLTS * VOLTAGE_SHARE * one.size) for one in _of(programme, Activity.SUPPLY)]
    before = [0.0, *(level for _, level in levels)]
    return [
        {"time": _s(time), "change": round(level - last, 6)}
        for (time, level), last in zip(levels, before, strict=False)
    ]


def _power(programme: Programme) -> list[Document]:
    pauses = _of(programme, Activity.POWER)
    starts = [0.0, *(one.time + one.duration for one in pauses)]
    entries: list[Document] = [
        {"start": _s(start), "end": _s(one.time)} for start, one in zip(starts, pauses, strict=False)
    ]
    return [*entries, {"start": _s(starts[-1])}]


def _motion(programme: Programme) -> Document:
    shocks = [
        {"time": _s(one.time), "axis": "z", "peak_g": PEAK_G * one.size, "width": one.duration}
        for one in _of(programme, Activity.SHOCKS)
    ]
    vibrations = [
        {
            "start": _s(one.time),
            "end": _s(one.time + one.duration),
            "axis": "z",
            "rms_g": RMS_G * one.size,
            "band": BAND,
        }
        for one in _of(programme, Activity.VIBRATION)
    ]
    held = _orientations(programme)
    parts = {"orientations": held, "shocks": shocks, "vibrations": vibrations}
    return {name: entries for name, entries in parts.items() if entries}


def _orientations(programme: Programme) -> list[Document]:
    """Return what the sensor feels along y and z: levels of y stay, levels of z are left again after +A and −A."""
    changes: list[tuple[float, int, float]] = [
        (one.time, 1, LATERAL_G * one.size) for one in _of(programme, Activity.LATERAL)
    ]
    for one in _of(programme, Activity.LEVELS):
        for number, level in enumerate((one.size, -one.size, 0.0)):
            changes.append((one.time + number * one.duration, 2, 1.0 + LARGEST_G * level))
    felt, entries = [0.0, 0.0, 1.0], []
    for time, axis, level in sorted(changes):
        felt[axis] = level
        entries.append({"time": _s(time), "specific_force_g": [round(value, 3) for value in felt], "turn": 1.0})
    first = {"time": 0.0, "specific_force_g": [0.0, 0.0, 1.0]}
    return [first, *entries] if entries else []


def _effect(programme: Programme, name: str) -> Document:
    parameters = dict(EXAMPLES[name])
    if name in MEMORIES and programme.wishes.time_constant is not None:
        span = kinds()[name].spans["time_constant"]
        parameters["time_constant"] = min(max(programme.wishes.time_constant, span.lower), span.upper)
    if name == "threshold_step":
        parameters["temperature"] = round(0.4 * programme.wishes.lowest + 0.6 * programme.wishes.highest, 1)
    return {"effect": name, "axes": ["z"], "declare": True, **parameters}


def _s(time: float) -> float:
    return round(time, 1)
