"""The sensor that every part of the benchmark looks at: still, in an oven, with white noise of one density."""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STILL = 9.80665
DENSITY = 1e-3
"""White noise, m/s²/√Hz: at every rate what the trained filter expects, so that its gate stays closed."""

LOWEST, HIGHEST, PERIOD = -5.0, 55.0, 3600.0
"""°C between which the oven goes up and down, and s of a cycle."""

THERMISTOR_NOISE = 0.01
SEED = 20190218


def temperature(seconds: Array) -> Array:
    """Return the oven's temperature (n,), °C, at times (n,) in s; it begins in the middle, on its way up."""
    phase = (seconds / PERIOD + 0.25) % 1.0
    return np.asarray(LOWEST + (HIGHEST - LOWEST) * (1.0 - np.abs(2.0 * phase - 1.0)))


def drift(celsius: Array) -> Array:
    """Return the drift (n, 3), m/s², at temperatures (n,): smooth, bent, another one on each axis."""
    x = (celsius - 25.0) / 35.0
    shape = 0.4 * x + 0.15 * x**2 + 0.1 * np.sin(2.0 * x)
    return np.asarray(shape[:, None] * np.array([2.0, 1.0, 0.5]))


def accelerations(seconds: Array, rate: float, random: np.random.Generator) -> Array:
    """Return what the sensor says (n, 3), m/s², at times (n,) in s, sampled at a rate in Hz."""
    noise = DENSITY * sqrt(rate) * random.standard_normal((len(seconds), 3))
    return np.asarray(np.array([0.0, 0.0, STILL]) + drift(temperature(seconds)) + noise)
