"""What the thermistor, the second thermometer and the voltage log show."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.simulation.description import Supply, Thermometer
from hgma_compensation.simulation.filters import low_pass
from hgma_compensation.simulation.oven import GRID, Temperatures

Array = NDArray[np.float64]


def read_out(true: Array, noise: float, resolution: float, random: np.random.Generator) -> Array:
    """Return samples (n,) of a true value (n,) with white noise, rounded to the resolution (0: not)."""
    noisy = true + noise * random.standard_normal(len(true))
    return np.asarray(resolution * np.rint(noisy / resolution) if resolution > 0.0 else noisy)


def thermistor_temperature(thermometer: Thermometer, oven: Temperatures) -> Array:
    """Return the temperature (m,) of the thermistor, which sits on the sensor and follows with its lag."""
    return low_pass(oven.sensor, thermometer.lag, GRID)


def package_temperature(thermometer: Thermometer, oven: Temperatures) -> Array:
    """Return the temperature (m,) of the second thermometer, on the package: the chamber's and outside heat, lagged."""
    around = oven.chamber.copy()
    for heating in thermometer.heating:
        around[(oven.time >= heating.start) & (oven.time < heating.end)] += heating.rise
    return low_pass(around, thermometer.lag, GRID)


def supply_voltage(supply: Supply, time: Array) -> Array:
    """Return the true supply voltage (n,) at times (n,): nominal, slow wander, steps."""
    voltage = supply.nominal + supply.wander * np.sin(2.0 * np.pi * time / supply.wander_period)
    for step in supply.steps:
        voltage[time >= step.time] += step.change
    return np.asarray(voltage)
