"""An oven test with one effect and no noise, for each effect: what its page shows."""

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from hgma_compensation.recording.csv_table import STANDARD_GRAVITY
from hgma_compensation.recording.recording import Series
from hgma_compensation.simulation.oven_test import Simulated, simulate_with_truth
from hgma_compensation.simulation.scenario import read_scenario

Array = NDArray[np.float64]
Document = dict[str, Any]

PROGRAM = [
    {"to": -10.0, "rate": 1.0, "soak": 20.0},
    {"to": 60.0, "rate": 1.0, "soak": 20.0},
    {"to": 10.0, "rate": 2.0, "soak": 20.0},
    {"to": 40.0, "rate": 2.0, "soak": 20.0},
    {"to": 25.0, "rate": 2.0, "soak": 30.0},
]
"""About the same for all, so that pictures can be compared: two rates, soaks and a minor loop, 5 h."""

BASE: Document = {
    "scenario": 1,
    "seed": 1,
    "ground_truth": True,
    "oven": {"start": 25.0, "chamber_time_constant": 30.0, "time_constant": 60.0, "program": PROGRAM},
    "thermistor": {"rate": 1.0, "noise": 0.0},
    "accelerometer": {"rate": 1.0, "axes": {"x": {}, "z": {"drift_span_g": 5367.0}}},
}

HOUR = 3600.0
TURNS = [
    {"time": 900.0 * k, "specific_force_g": [20.0 * np.sin(1.7 * k), 0.0, 100.0 * np.sin(2.4 * k)]}
    for k in range(1, 17)
]
"""A turntable's centrifuge: another force along x and z every 15 min."""


def effect(name: str, **parameters: Any) -> Document:
    """Return the entry of an effect on z."""
    return {"effect": name, "axes": ["z"], **parameters}


SCENARIOS: dict[str, tuple[Document, Document]] = {
    "aging": (effect("aging", rate=20.0, logarithmic_after=2.0 * HOUR), {}),
    "cross_axis": (effect("cross_axis", source="x", gain=0.02), {"motion": {"orientations": TURNS}}),
    "hysteresis": (effect("hysteresis", width=200.0, threshold=4.0), {}),
    "periodic_interference": (effect("periodic_interference", amplitude=40.0, period=600.0), {}),
    "post_shock_zero_shift": (
        effect("post_shock_zero_shift", permanent=0.002, transient=0.006, time_constant=900.0),
        {
            "motion": {
                "shocks": [
                    {"time": hour * HOUR, "axis": "z", "peak_g": peak, "width": 0.001}
                    for hour, peak in ((1.0, 3000.0), (2.2, 5000.0), (3.6, -4000.0))
                ]
            }
        },
    ),
    "quadratic_nonlinearity": (
        effect("quadratic_nonlinearity", fraction=0.02, level=100.0 * STANDARD_GRAVITY),
        {"motion": {"orientations": TURNS}},
    ),
    "rate_dependent_hysteresis": (effect("rate_dependent_hysteresis", amplitude=100.0, exponent=0.5), {}),
    "scale_factor_temperature": (
        effect("scale_factor_temperature", linear=0.05, quadratic=0.01),
        {"motion": {"orientations": TURNS}},
    ),
    "stress_relaxation": (effect("stress_relaxation", gain=10.0, time_constant=HOUR, decades=0.4), {}),
    "supply_voltage": (
        effect("supply_voltage", gain=2000.0, temperature_gain=600.0),
        {
            "supply_voltage": {
                "rate": 1.0,
                "nominal": 5.0,
                "steps": [
                    {"time": hour * HOUR, "change": change}
                    for hour, change in ((0.7, 0.06), (1.5, -0.1), (2.4, 0.08), (3.4, 0.05), (4.2, -0.11))
                ],
            }
        },
    ),
    "thermal_gradient": (
        effect("thermal_gradient", gain=60.0, bend=0.3),
        {
            "second_thermometer": {
                "rate": 1.0,
                "noise": 0.0,
                "lag": 40.0,
                "heating": [{"start": 2.2 * HOUR, "end": 2.6 * HOUR, "rise": 4.0}],
            }
        },
    ),
    "thermal_lag": (effect("thermal_lag", time_constant=120.0), {}),
    "threshold_step": (effect("threshold_step", temperature=33.0, height=80.0), {}),
    "timing_offset": (effect("timing_offset", delay=30.0), {}),
    "vibration_rectification": (
        effect("vibration_rectification", coefficient=0.05, time_constant=60.0),
        {
            "motion": {
                "vibrations": [
                    {"start": hour * HOUR, "end": (hour + 0.4) * HOUR, "axis": "z", "rms_g": rms, "band": [20.0, 200.0]}
                    for hour, rms in ((0.8, 2.0), (2.0, 4.0), (3.2, 6.0))
                ]
            }
        },
    ),
    "warm_up": (
        effect("warm_up", amplitude=100.0, time_constant=600.0),
        {
            "power": [
                {"start": 0.0, "end": 1.5 * HOUR},
                {"start": 2.0 * HOUR, "end": 3.2 * HOUR},
                {"start": 3.5 * HOUR},
            ]
        },
    ),
}
"""For each effect its entry, and what must happen beside the oven's programme for it to show."""


@dataclass(frozen=True)
class Shown:
    """time: (n,) h. temperature: (n,) °C and rate: (n,) °C/min of the sensor. drift: (n,) m/s² of the effect alone.

    acceleration: (n, 3) m/s² that the sensor undergoes. temperature_2, voltage: (n,) °C, V, None where there is none.
    """

    time: Array
    temperature: Array
    rate: Array
    drift: Array
    acceleration: Array
    temperature_2: Array | None
    voltage: Array | None


def show(name: str) -> Shown:
    """Return the oven test of an effect: its drift is the difference to the same test without it."""
    entry, beside = SCENARIOS[name]
    with_it, without = _simulated({**BASE, **beside, "effects": [entry]}), _simulated({**BASE, **beside})
    stamps = with_it.recording.stamps
    temperature, seconds = with_it.truth.temperature, (stamps - stamps[0]) * 1e-9
    return Shown(
        time=seconds / HOUR,
        temperature=temperature,
        rate=60.0 * np.gradient(temperature, seconds),
        drift=with_it.truth.drift[:, 2] - without.truth.drift[:, 2],
        acceleration=with_it.truth.acceleration,
        temperature_2=_at(with_it.recording.temperature_2, stamps),
        voltage=_at(with_it.recording.supply_voltage, stamps),
    )


def _at(series: Series, stamps: NDArray[np.int64]) -> Array | None:
    return np.interp(stamps, series.stamps, series.values) if len(series.stamps) else None


def _simulated(document: Document) -> Simulated:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "scenario.yaml"
        path.write_text(yaml.safe_dump(_plain(document)), encoding="utf-8")
        return simulate_with_truth(read_scenario(path))


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [_plain(entry) for entry in value]
    return value.item() if isinstance(value, np.generic) else value
