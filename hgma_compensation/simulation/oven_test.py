"""A scenario made into a recording, and into the truth behind it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import AXES, CHANNELS
from hgma_compensation.recording.ground_truth import GroundTruth
from hgma_compensation.recording.recording import Recording, Series
from hgma_compensation.simulation.description import Scenario, Thermometer
from hgma_compensation.simulation.noise import streams_of
from hgma_compensation.simulation.oven import Temperatures, power_state, temperatures
from hgma_compensation.simulation.sensor import Sensor
from hgma_compensation.simulation.thermometers import (
    package_temperature,
    read_out,
    supply_voltage,
    thermistor_temperature,
)
from hgma_compensation.stamps import NANOSECONDS, Stamps

Array = NDArray[np.float64]
EPOCH = 1_600_000_000 * NANOSECONDS
"""Stamp of the beginning, ns: fixed, so that a seed gives the same recording on any day."""


@dataclass(frozen=True)
class Simulated:
    """A recording and what is behind it."""

    recording: Recording
    truth: GroundTruth


def simulate(scenario: Scenario) -> Recording:
    """Return the recording of a scenario; the same seed gives the same bits."""
    return simulate_with_truth(scenario).recording


def simulate_with_truth(scenario: Scenario) -> Simulated:
    """Return the recording of a scenario, and the truth at the stamps of its accelerometer."""
    streams, oven = streams_of(scenario.seed), temperatures(scenario.oven)
    sensor = Sensor(scenario, oven, streams)
    on = power_state(scenario.powered, sensor.time)
    drifts, values = _all_axes(scenario, sensor)
    recording = Recording(
        name=scenario.name,
        stamps=_stamps(sensor.time[on]),
        values=values[on],
        present=tuple(f"linear_acceleration.{axis}" for axis in AXES if axis in scenario.axes),
        temperature=_thermometer(scenario, scenario.thermistor, thermistor_temperature, oven, streams("thermistor")),
        temperature_2=_thermometer(
            scenario, scenario.second_thermometer, package_temperature, oven, streams("second thermometer")
        ),
        supply_voltage=_voltage(scenario, streams("supply voltage")),
        frame=scenario.sensor_id,
    )
    truth = GroundTruth(sensor.temperature[on], sensor.acceleration[on], drifts[on], _declared(scenario))
    return Simulated(recording, truth)


def _all_axes(scenario: Scenario, sensor: Sensor) -> tuple[Array, Array]:
    """Return drifts (n, 3) and readings (n, 6), zero where the scenario has no axis."""
    drifts, values = np.zeros((len(sensor.time), len(AXES))), np.zeros((len(sensor.time), len(CHANNELS)))
    for axis in scenario.axes:
        column = AXES.index(axis)
        drifts[:, column] = sensor.drift(axis)
        values[:, column] = sensor.readings(axis, drifts[:, column])
    return drifts, values


def _declared(scenario: Scenario) -> tuple[dict[str, Any], ...]:
    return tuple({"effect": e.name, "axes": list(e.axes), **vars(e.effect)} for e in scenario.effects if e.declared)


def _thermometer(
    scenario: Scenario,
    thermometer: Thermometer | None,
    true: Callable[[Thermometer, Temperatures], Array],
    oven: Temperatures,
    random: np.random.Generator,
) -> Series:
    if thermometer is None:
        return Series.empty()
    time = _powered_times(scenario, thermometer.rate)
    at_samples = np.interp(time, oven.time, true(thermometer, oven))
    return Series(_stamps(time), read_out(at_samples, thermometer.noise, thermometer.resolution, random))


def _voltage(scenario: Scenario, random: np.random.Generator) -> Series:
    supply = scenario.supply
    if supply is None:
        return Series.empty()
    time = _powered_times(scenario, supply.rate)
    return Series(_stamps(time), read_out(supply_voltage(supply, time), supply.noise, 0.0, random))


def _powered_times(scenario: Scenario, rate: float) -> Array:
    """Return the times (n,) in s at which a channel of that rate (Hz) is sampled."""
    time = np.arange(int(scenario.oven.duration * rate)) / rate
    return np.asarray(time[power_state(scenario.powered, time)])


def _stamps(time: Array) -> Stamps:
    return EPOCH + np.rint(time * NANOSECONDS).astype(np.int64)
