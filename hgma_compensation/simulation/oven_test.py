"""Temperature of the sensor in the oven, and what thermistor and accelerometer make of it."""

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from hgma_compensation.channels import AXES, CHANNELS
from hgma_compensation.recording.recording import Recording, Series
from hgma_compensation.simulation.scenario import Axis, Oven, Scenario
from hgma_compensation.stamps import NANOSECONDS

Array = NDArray[np.float64]
EPOCH = 1_600_000_000 * NANOSECONDS
"""Stamp of the first sample, ns: fixed, so that a seed gives the same recording on any day."""

GRID = 0.1
"""Step of the temperature's simulation, s: far below any time constant of an oven."""


def simulate(scenario: Scenario) -> Recording:
    """Return the recording of a scenario; the same seed gives the same bits."""
    random = np.random.default_rng(scenario.seed)
    grid, temperature = sensor_temperature(scenario.oven)
    thermistor_time = _times(scenario.oven.duration, scenario.thermistor_rate)
    measured = np.interp(thermistor_time, grid, temperature)
    measured = measured + scenario.thermistor_noise * random.standard_normal(len(measured))
    time = _times(scenario.oven.duration, scenario.accelerometer_rate)
    true_temperature = np.interp(time, grid, temperature)
    rate = np.interp(time, grid, np.gradient(temperature, GRID))
    values = np.zeros((len(time), len(CHANNELS)))
    for axis, description in scenario.axes.items():
        noise = description.white_noise * np.sqrt(scenario.accelerometer_rate) * random.standard_normal(len(time))
        drift = static_drift(true_temperature, description) + description.rate_drift * 60.0 * rate
        values[:, AXES.index(axis)] = description.true_value + drift + noise
    return Recording(
        name=scenario.name,
        stamps=_stamps(time),
        values=values,
        present=tuple(f"linear_acceleration.{axis}" for axis in AXES if axis in scenario.axes),
        temperature=Series(_stamps(thermistor_time), measured),
        frame=scenario.sensor_id,
    )


def sensor_temperature(oven: Oven) -> tuple[Array, Array]:
    """Return times (n,) in s and the temperature (n,) of the sensor, which lags the set-point."""
    corners, before, now = [(0.0, oven.start)], oven.start, 0.0
    for step in oven.program:
        now += 60.0 * abs(step.to - before) / step.rate
        corners.append((now, step.to))
        now += 60.0 * step.soak
        corners.append((now, step.to))
        before = step.to
    grid = np.arange(0.0, oven.duration + GRID, GRID)
    set_point = np.interp(grid, *np.array(corners).T)
    keep = np.exp(-GRID / oven.time_constant)
    follows, _ = lfilter([1.0 - keep], [1.0, -keep], set_point, zi=[keep * oven.start])
    return grid, follows


def static_drift(temperature: Array, axis: Axis) -> Array:
    """Return the drift (n,) at temperatures (n,): bent like a piezoresistive bridge's, monotone, no network.

    It changes by ``drift_span`` between -10 and 60 °C and is zero at 25 °C.
    """
    shape = _shape(temperature) - _shape(np.array(25.0))
    low, high = _shape(np.array([-10.0, 60.0]))
    return np.asarray(axis.drift_span * shape / (high - low))


def _shape(temperature: Array) -> Array:
    x = (temperature - 25.0) / 35.0
    return np.asarray(x + 0.25 * x**2 + 0.3 * np.tanh(1.5 * (x - 0.4)) - 0.1 * np.exp(-(x**2)))


def _times(duration: float, rate: float) -> Array:
    return np.arange(int(duration * rate)) / rate


def _stamps(time: Array) -> NDArray[np.int64]:
    return EPOCH + np.rint(time * NANOSECONDS).astype(np.int64)
